// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "plugins/step/odograph/stair_detector.hpp"
#include "sdk/tools/simulation/random.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("steps");

TEST_CASE("stairs are detected from pressure despite wind") {
  for (const double rate_hz : {1.0, 10.0}) {
    CAPTURE(rate_hz);
    Random random(4, 4);
    double gust = 0, wrong_s = 0, climbed_s = 0, late_s = 0;
    steps::StairDetector stairs;
    for (int i = 0; i < 600 * rate_hz; ++i) {
      const double t = i / rate_hz, keep = std::exp(-1 / (4 * rate_hz));
      gust = keep * gust + 4 * std::sqrt(1 - keep * keep) * random.normal();
      const double up_m = 0.28 * (std::clamp(t - 200, 0.0, 15.0) - std::clamp(t - 400, 0.0, 15.0));  // two flights
      stairs.add(static_cast<int64_t>(t * 1e9), 101325 - up_m / 0.0843 + gust + 2 * random.normal());
      const bool truth = (t > 200 && t < 215) || (t > 400 && t < 415);
      if (stairs.on_stairs() && !(t > 200 && t < 225) && !(t > 400 && t < 425)) wrong_s += 1 / rate_hz;
      if (truth) (stairs.on_stairs() ? climbed_s : late_s) += 1 / rate_hz;
    }
    CHECK(wrong_s < 6);     // of ten minutes
    CHECK(climbed_s > 10);  // of thirty seconds, with the window's delay of ten seconds twice
  }
}

TEST_CASE("a street of 17 % lifts as fast as stairs but is not taken for them, since the steps have the usual length") {
  const auto stairs_s = [](double length_m, double period_s) {
    Random random(5, 4);
    double gust = 0, on_s = 0, next_s = 30;
    steps::StairDetector stairs;
    for (int t = 0; t < 90; ++t) {
      gust = std::exp(-0.25) * gust + 4 * std::sqrt(1 - std::exp(-0.5)) * random.normal();
      const double up_m = 0.24 * std::clamp(t - 30.0, 0.0, 30.0);
      stairs.add(t * 1'000'000'000ll, 101325 - up_m / 0.0843 + gust + 2 * random.normal());
      for (; next_s < t; next_s += period_s)
        stairs.add_step(static_cast<int64_t>(next_s * 1e9), static_cast<int64_t>((next_s + period_s) * 1e9), length_m);
      on_s += stairs.on_stairs();
    }
    return on_s;
  };
  CHECK(stairs_s(0.75, 0.53) == 0);
  CHECK(stairs_s(0.40, 0.58) > 20);  // treads, estimated as somewhat longer steps
}

TEST_CASE("stairs end ten seconds after the last pressure sample, though steps continue") {
  steps::StairDetector stairs;
  for (int i = 0; i < 30; ++i) {
    stairs.add(i * 1'000'000'000ll, 101325 - 0.28 * i / 0.0843);
    stairs.add_step(i * 1'000'000'000ll, i * 1'000'000'000ll + 600'000'000, 0.35);
  }
  REQUIRE(stairs.on_stairs());
  for (int i = 30; i < 39; ++i) stairs.add_step(i * 1'000'000'000ll, i * 1'000'000'000ll + 600'000'000, 0.35);
  CHECK(stairs.on_stairs());
  for (int i = 39; i < 45; ++i) stairs.add_step(i * 1'000'000'000ll, i * 1'000'000'000ll + 600'000'000, 0.35);
  CHECK_FALSE(stairs.on_stairs());
}

TEST_SUITE_END();
