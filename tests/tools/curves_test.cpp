// SPDX-License-Identifier: Apache-2.0
//
// Curves of benchmarks with known points.
#include <doctest/doctest.h>

#include "sdk/tools/evaluation/corner_flow.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("figures");

TEST_CASE("a distribution has its percentiles, and errors are compared at the same percentiles") {
  const auto points = distribution_of({3, 1, 2});
  REQUIRE(points.size() == 101);
  CHECK(points[0] == std::pair(1.0, 0.0));
  CHECK(points[50].first == doctest::Approx(2));
  CHECK(points[100] == std::pair(3.0, 1.0));
  CHECK(part_below({1, 5, 3, 0}, {2, 4, 3, 1}) == doctest::Approx(0.5));
}

TEST_CASE("the share of corners still tracked decreases with the track length, up to half of the frames") {
  TrackFigures f;
  f.lengths = {1, 2, 2, 4}, f.frames = 8;
  const auto still = f.survival();
  REQUIRE(still.size() == 4);
  CHECK(still[0] == std::pair(1.0, 1.0));
  CHECK(still[1] == std::pair(2.0, 0.75));
  CHECK(still[3] == std::pair(4.0, 0.25));
  CHECK(TrackFigures{}.survival().empty());
}

TEST_SUITE_END();
