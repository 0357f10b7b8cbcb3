// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/model_to_navigation.hpp"

#include <algorithm>
#include <stdexcept>

namespace odograph::skyline {
namespace {

using Eigen::Vector3d;

/// The median of each of the first two coordinates: single points far away do not move it.
ModelPoint middle_of(const std::vector<Vector3d>& points) {
  ModelPoint middle;
  std::vector<double> values(points.size());
  for (const int axis : {0, 1}) {
    if (points.empty()) break;
    std::transform(points.begin(), points.end(), values.begin(), [&](const Vector3d& p) { return p[axis]; });
    const auto median = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), median, values.end());
    (axis == 0 ? middle.first : middle.second) = *median;
  }
  return middle;
}

/// What prevents coordinates from being easting, northing and height in metres, if anything. Systems that PROJ does not
/// know, and places outside a system's area, decide nothing: the model may be shifted.
std::string why_not_metres(const SystemName& name, const ModelPoint& middle) {
  try {
    ReferenceSystem system(name);
    if (system.unit_m() == 0) return "its coordinates are degrees";
    if (system.unit_m() != 1 || system.height_unit_m() != 1) return "its coordinates are in the unit " + system.unit();
    if (system.northing_first() && system.choose_around(middle) == ReferenceSystem::Order::named)
      return "its coordinates have northing first";
  } catch (const std::runtime_error&) {
  }
  return "";
}

}  // namespace

ModelToNavigation::ModelToNavigation(const CityPlacement& placement, const std::string& system,
                                     const std::vector<Vector3d>& points, const std::string& file)
    : p_(placement) {
  const SystemName name = parse_system_name(system);
  if (!p_.geodetic) {
    if (name.epsg == 0) return;
    if (const std::string why = why_not_metres(name, middle_of(points)); !why.empty())
      throw std::runtime_error(
          file + ": " + why + " (" + system +
          "): place it by latitude and longitude, or convert it to easting, northing and height in "
          "metres");
    return;
  }
  try {
    system_.emplace(name);
    if (!points.empty()) system_->choose_around(middle_of(points));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
  local_.Reset(p_.geodetic_origin[0], p_.geodetic_origin[1], p_.geodetic_origin[2]);
}

Vector3d ModelToNavigation::operator()(const Vector3d& at) const {
  if (!system_) {
    const Vector3d d = at - Vector3d(p_.model_origin.data());
    return {d.y(), d.x(), -d.z()};
  }
  const Geodetic g = system_->geodetic({at.x(), at.y()});
  double east = 0, north = 0, up = 0;
  local_.Forward(g.latitude_deg, g.longitude_deg, at.z() * system_->height_unit_m() + p_.geoid_height_m, east, north,
                 up);
  return {north, east, -up};
}

Vector3d ModelToNavigation::operator()(const Vector3d& reference_point, const Vector3d& offset) const {
  if (!system_ || system_->unit_m() != 0) return (*this)(reference_point + offset);
  return (*this)(reference_point) + Vector3d(offset.y(), offset.x(), -offset.z());
}

Georeference ModelToNavigation::georeference() const {
  return system_ ? Georeference{system_->description(), system_->accuracy_m()} : Georeference{};
}

}  // namespace odograph::skyline
