// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sdk/host/base/result.hpp"
#include "sdk/host/config/overrides.hpp"

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

/// What gives a config's fix/skyline the model, with its n's origin, and a database of skylines, if one is named.
std::vector<Override> skyline_overrides(const std::filesystem::path& model, const Eigen::Vector3d& origin,
                                        const std::string& skylines);

}  // namespace odograph
