// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/terrain/placement.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "plugins/shared/projection.hpp"

namespace odograph::terrain {
namespace {
constexpr int kWgs84 = 4326;  // EPSG
}

struct Placement::Earth {
  GeographicLib::LocalCartesian local;
  Projection projection;
};

Placement::Placement(const Parameters& parameters, const Reference& reference) : p_(parameters) {
  if (!p_.geodetic) return;
  const auto& o = p_.geodetic_origin;
  const auto projection = reference.geographic ? Projection::of(kWgs84) : Projection::of(reference.epsg);
  if (!projection)
    throw std::runtime_error("geodetic_origin: the model's projection (EPSG " + std::to_string(reference.epsg) +
                             ") is not supported; set model_origin in its coordinates");
  earth_.reset(new Earth{GeographicLib::LocalCartesian(o[0], o[1], o[2]), *projection});
}

Placement::~Placement() = default;
Placement::Placement(Placement&&) noexcept = default;
Placement& Placement::operator=(Placement&&) noexcept = default;

bool Placement::ground_at(const Terrain& terrain, double north_m, double east_m, double expected_down_m,
                          double& down_m) const {
  double height_m = 0;
  if (!earth_) {
    const double c = std::cos(p_.grid_north_rad), s = std::sin(p_.grid_north_rad), zero_m = p_.model_origin[2];
    const double grid_east = c * east_m - s * north_m, grid_north = s * east_m + c * north_m;
    if (!terrain.height_at(p_.model_origin[0] + grid_east, p_.model_origin[1] + grid_north, zero_m - expected_down_m,
                           height_m))
      return false;
    down_m = zero_m - height_m;
    return true;
  }
  double latitude = 0, longitude = 0, height = 0, x = 0, y = 0, up = 0;
  earth_->local.Reverse(east_m, north_m, -expected_down_m, latitude, longitude, height);
  const auto at = earth_->projection.grid({latitude, longitude});
  if (!at || !terrain.height_at(at->easting_m, at->northing_m, height - p_.geoid_height_m, height_m)) return false;
  earth_->local.Forward(latitude, longitude, height_m + p_.geoid_height_m, x, y, up);
  down_m = -up;
  return true;
}

}  // namespace odograph::terrain
