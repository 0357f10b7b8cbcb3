// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "sdk/host/base/result.hpp"

namespace odograph {

struct CityScenario {
  std::string model, output;
  std::string lens = "wide";    ///< wide, narrow (both look up) or forward
  std::string carrier = "car";  ///< car or walker
  uint64_t seed = 1;
  double length_m = 300;
};

/// Draws a route through a model's streets and writes it as a scenario. Gives easting, northing and height of its n's
/// origin in the model: the ground where it starts.
Result<Eigen::Vector3d> write_city_scenario(const CityScenario& wanted);

}  // namespace odograph
