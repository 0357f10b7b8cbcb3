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
  std::string lens = "wide";    ///< wide, narrow (both face up) or forward
  std::string carrier = "car";  ///< car or walker
  uint64_t seed = 1;
  double length_m = 300;
};

/// Generates a route through a model's streets and writes it as a scenario. Returns easting, northing and height of its
/// n's origin in the model: the ground at the start.
Result<Eigen::Vector3d> write_city_scenario(const CityScenario& wanted);

/// Overrides that set the model, with its n's origin, and a database of skylines, if any, in a config's fix/skyline.
std::vector<Override> skyline_overrides(const std::filesystem::path& model, const Eigen::Vector3d& origin,
                                        const std::string& skylines);

}  // namespace odograph
