// SPDX-License-Identifier: Apache-2.0
//
// Standing, a few steps, standing again: the steps are found, and the first ones are shorter.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "plugins/step/odograph/gait_finder.hpp"
#include "plugins/step/odograph/length_model.hpp"
#include "sdk/tools/simulation/random.hpp"

using namespace odograph;
using namespace odograph::steps;

TEST_SUITE_BEGIN("steps");

namespace {

/// Steps at 1.8 Hz within these times, s; standing in between.
std::vector<FoundStep> found_in(const std::vector<std::pair<double, double>>& walks) {
  constexpr double kStep_hz = 1.8, kRise_m = 0.04, kTwoPi = 6.283185307179586;
  Resampler resampler;
  GaitFinder finder;
  Random random(5, 1);
  std::vector<FoundStep> steps;
  for (double t = 0; t < walks.back().second + 5; t += 0.01) {
    double up = 0.1 * random.normal();
    bool on = false;
    for (const auto& [from_s, to_s] : walks)
      if (t > from_s && t < to_s)
        on = true, up += 0.5 * kRise_m * std::pow(kTwoPi * kStep_hz, 2) * std::cos(kTwoPi * kStep_hz * (t - from_s));
    resampler.push(
        {.t_ns = static_cast<int64_t>(t * 1e9), .vertical = up, .level = on ? 0.6 : 0.05, .gyro = 0.05},
        [&](const WalkSample& s) {
          finder.add(s);
          for (const FoundStep& step : finder.found()) steps.push_back(step);
        },
        [&] { finder.reset(); });
  }
  return steps;
}

size_t between(const std::vector<FoundStep>& steps, double from_s, double to_s) {
  return static_cast<size_t>(std::count_if(steps.begin(), steps.end(), [&](const FoundStep& step) {
    return step.t_end_ns > static_cast<int64_t>(from_s * 1e9) && step.t_end_ns < static_cast<int64_t>(to_s * 1e9);
  }));
}

}  // namespace

TEST_CASE("three steps between two stops count shortly after a walk, and may be gestures otherwise") {
  const double few_s = 2.4 / 1.8;  // three contacts
  const auto after = found_in({{4, 14}, {17, 17 + few_s}, {20, 20 + few_s}});
  CHECK(between(after, 16, 19) >= 2);
  CHECK(between(after, 19, 23) >= 2);
  CHECK(between(found_in({{4, 4 + few_s}, {7, 7 + few_s}}), 0, 12) == 0);
  const auto later = found_in({{4, 14}, {40, 40 + few_s}});
  CHECK(between(later, 30, 45) == 0);
}

TEST_CASE("the first step after a stop is half a step, and the fifth almost a whole one") {
  const auto steps = found_in({{4, 14}, {18, 28}});
  const LengthModel model;
  std::vector<double> parts;
  for (FoundStep step : steps) {
    if (step.t_end_ns < 16'000'000'000) continue;
    const double length_m = model.length_m(step);
    step.since_stood = 100;
    parts.push_back(length_m / model.length_m(step));
  }
  REQUIRE(parts.size() > 10);
  CHECK(parts[0] == doctest::Approx(0.5));
  CHECK(parts[1] > 0.7);
  CHECK(parts[4] > 0.95);
  CHECK(parts.back() > 0.999);
}

TEST_SUITE_END();
