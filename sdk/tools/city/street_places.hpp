// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {

struct StreetPlaceParameters {
  double spacing_m = 2.0;
  double eye_m = 1.5;   ///< above the ground
  double cell_m = 0.5;  ///< of the map of buildings
  size_t most = 20'000'000;
};

/// Places of a grid over a model outside its buildings, north, east and down in its n, m. Fails where there are too
/// many.
Result<std::vector<Eigen::Vector3d>> places_of_grid(const CityModel& city,
                                                    const StreetPlaceParameters& parameters = {});
/// Places along a line through the model, `spacing_m` apart, including its ends, also inside buildings.
Result<std::vector<Eigen::Vector3d>> places_along(const CityModel& city, const std::vector<Eigen::Vector2d>& north_east,
                                                  const StreetPlaceParameters& parameters = {});

}  // namespace odograph
