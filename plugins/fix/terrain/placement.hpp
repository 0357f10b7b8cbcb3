// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>

#include "plugins/fix/terrain/terrain.hpp"

namespace odograph::terrain {

/// Placement of n in the coordinates of a model. Immutable.
class Placement {
 public:
  struct Parameters {
    std::array<double, 3> model_origin = {0, 0, 0};     ///< easting, northing and height of n's origin in the model, m
    double grid_north_rad = 0;                          ///< direction of the model's north, from true north to the east
    std::array<double, 3> geodetic_origin = {0, 0, 0};  ///< latitude and longitude in degrees, ellipsoidal height in m
    bool geodetic = false;      ///< geodetic_origin replaces model_origin, by the model's reference system
    double geoid_height_m = 0;  ///< ellipsoidal height of the model's zero height
  };
  /// Throws std::runtime_error where the model's reference system does not suit the origin.
  Placement(const Parameters& parameters, const Reference& reference);
  ~Placement();
  Placement(Placement&&) noexcept;
  Placement& operator=(Placement&&) noexcept;

  /// Down coordinate of the ground at a position of n, m; false if the model has none. Of several surfaces the one
  /// nearest to `expected_down_m`.
  bool ground_at(const Terrain& terrain, double north_m, double east_m, double expected_down_m, double& down_m) const;

  /// Reference system, transformation and accuracy; empty without a geodetic origin.
  std::string description() const;
  /// Of the transformation to WGS 84, horizontally, m, as published.
  double accuracy_m() const;

 private:
  struct Earth;
  Parameters p_;
  double height_unit_m_ = 1;
  std::unique_ptr<Earth> earth_;
};

}  // namespace odograph::terrain
