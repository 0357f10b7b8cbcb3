// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/terrain/placement.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "plugins/shared/reference_system.hpp"

namespace odograph::terrain {
namespace {
constexpr int kWgs84 = 4326;  // EPSG
}

struct Placement::Earth {
  GeographicLib::LocalCartesian local;
  ReferenceSystem system;
};

Placement::Placement(const Parameters& parameters, const Reference& reference) : p_(parameters) {
  if (reference.height_unit_m > 0) height_unit_m_ = reference.height_unit_m;
  const int epsg = reference.geographic && reference.epsg == 0 ? kWgs84 : reference.epsg;
  const SystemName name{epsg, reference.vertical_epsg, false};  // a raster's columns lie to the east
  if (!p_.geodetic) {
    if (epsg == 0) return;
    std::optional<ReferenceSystem> system;
    try {
      system.emplace(name);
    } catch (const std::runtime_error&) {
      return;  // unknown to PROJ; model_origin does not need it
    }
    if (system->unit_m() != 1)
      throw std::runtime_error("model_origin: the model's coordinates are in the unit " + system->unit() +
                               ", not in metres; set geodetic and geodetic_origin");
    if (reference.height_unit_m == 0) height_unit_m_ = system->height_unit_m();
    return;
  }
  const auto& o = p_.geodetic_origin;
  try {
    ReferenceSystem system(name);
    if (system.choose_around({reference.middle[0], reference.middle[1]}) == ReferenceSystem::Order::exchanged)
      throw std::runtime_error("easting and northing of the model are exchanged");
    if (reference.height_unit_m == 0) height_unit_m_ = system.height_unit_m();
    earth_.reset(new Earth{GeographicLib::LocalCartesian(o[0], o[1], o[2]), std::move(system)});
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string("geodetic_origin: ") + error.what() +
                             "; model_origin in the model's coordinates needs no reference system");
  }
}

std::string Placement::description() const { return earth_ ? earth_->system.description() : ""; }
double Placement::accuracy_m() const { return earth_ ? earth_->system.accuracy_m() : 0; }

Placement::~Placement() = default;
Placement::Placement(Placement&&) noexcept = default;
Placement& Placement::operator=(Placement&&) noexcept = default;

bool Placement::ground_at(const Terrain& terrain, double north_m, double east_m, double expected_down_m,
                          double& down_m) const {
  double height_m = 0;
  if (!earth_) {
    const double c = std::cos(p_.grid_north_rad), s = std::sin(p_.grid_north_rad), zero_m = p_.model_origin[2];
    const double grid_east = c * east_m - s * north_m, grid_north = s * east_m + c * north_m;
    if (!terrain.height_at(p_.model_origin[0] + grid_east, p_.model_origin[1] + grid_north,
                           (zero_m - expected_down_m) / height_unit_m_, height_m))
      return false;
    down_m = zero_m - height_m * height_unit_m_;
    return true;
  }
  double latitude = 0, longitude = 0, height = 0, x = 0, y = 0, up = 0;
  earth_->local.Reverse(east_m, north_m, -expected_down_m, latitude, longitude, height);
  const auto at = earth_->system.model({latitude, longitude});
  if (!at || !terrain.height_at(at->first, at->second, (height - p_.geoid_height_m) / height_unit_m_, height_m))
    return false;
  earth_->local.Forward(latitude, longitude, height_m * height_unit_m_ + p_.geoid_height_m, x, y, up);
  down_m = -up;
  return true;
}

}  // namespace odograph::terrain
