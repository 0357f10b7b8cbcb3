// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "sdk/base/result.hpp"

namespace CLI {
class App;
}

namespace odograph {

/// `odograph city ...`: city models, their skylines, routes through their streets.
void add_city(CLI::App& app, int& status);
/// `odograph city build`, `query` and `show`.
void add_city_skylines(CLI::App& city, int& status);
/// `odograph city bench`.
void add_bench_city(CLI::App& city, int& status);

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
