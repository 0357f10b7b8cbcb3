// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "plugins/fix/terrain/terrain.hpp"

namespace odograph::terrain {

/// Where n lies in a model's coordinates. Immutable.
class Placement {
 public:
  struct Parameters {
    std::array<double, 3> model_origin = {0, 0, 0};     ///< easting, northing and height of n's origin in the model, m
    double grid_north_rad = 0;                          ///< direction of the model's north, from true north to the east
    std::array<double, 3> geodetic_origin = {0, 0, 0};  ///< latitude and longitude in degrees, ellipsoidal height in m
    bool geodetic = false;      ///< geodetic_origin stands for model_origin, the model's projection being known
    double geoid_height_m = 0;  ///< ellipsoidal height of the model's zero height
  };
  /// Throws std::runtime_error where a geodetic origin needs a projection that is not known here: known are
  /// those of plugins/shared/projection.hpp.
  Placement(const Parameters& parameters, const Reference& reference);
  ~Placement();
  Placement(Placement&&) noexcept;
  Placement& operator=(Placement&&) noexcept;

  /// The ground under or over a place of n: its down coordinate in n, m; false where the model has none. Of several
  /// surfaces the one nearest to `expected_down_m`.
  bool ground_at(const Terrain& terrain, double north_m, double east_m, double expected_down_m, double& down_m) const;

 private:
  struct Earth;
  Parameters p_;
  std::unique_ptr<Earth> earth_;
};

}  // namespace odograph::terrain
