// SPDX-License-Identifier: Apache-2.0
//
// Places that the matcher must not return: outside its search, and the wrong one of two beside a wall.
#include "plugins/fix/skyline/matcher.hpp"
#include "tests/skyline/skyline_streets.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;
using test::a_street;
using test::add_box;
using test::kDegree;

TEST_SUITE_BEGIN("skyline_reach");

namespace {

const Eigen::Quaterniond kUp(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::Quaterniond(0, 1, 0, 0));

std::vector<SkyEdge> seen_from(const std::vector<Edge>& houses, const Vector3d& p_n, double lowest_deg = 10) {
  return test::seen_from(houses, p_n, kUp, lowest_deg);
}

Prior prior_at(const Vector3d& p_n, double sigma_m, double farthest_m, double height_sigma_m) {
  return {.p_n = p_n,
          .q_n_c = kUp,
          .position_sigma_m = sigma_m,
          .yaw_sigma_rad = kDegree,
          .tilt_sigma_rad = 0.6 * kDegree,
          .farthest_m = farthest_m,
          .height_sigma_m = height_sigma_m};
}

}  // namespace

TEST_CASE("a place that lies far above what the prior allows is not told") {
  const auto houses = a_street(16);
  for (const double up_m : {1.5, 8.0}) {
    Matcher matcher{City(houses)};
    const Vector3d eye(2, 1, -1.5 - up_m);
    const auto match = matcher.match(seen_from(houses, eye), prior_at(Vector3d(2.4, 0.7, -1.5), 2.5, 40, 1));
    CAPTURE(up_m);
    if (up_m < 3) {
      REQUIRE(match);
      CHECK((match->p_n - eye).norm() < 0.3);
    } else {
      CHECK_FALSE(match);
      CHECK(matcher.refusal() == Refusal::beyond);
    }
  }
}

TEST_CASE("beside a wall, where the lattice's places are wrong by most, the prior's place is found") {
  for (const double between_m : {6.0, 7.0, 9.0})
    for (const double off_north_m : {0.0, 0.3}) {
      const auto houses = a_street(between_m);
      Matcher matcher{City(houses)};
      const Vector3d eye(3.1, 0.5 * between_m - 0.05, -1.5);  // five centimetres from it; the prior lies behind it
      const auto match =
          matcher.match(seen_from(houses, eye), prior_at(eye + Vector3d(off_north_m, 0.3, 0), 0.1, 40, 0.1));
      CAPTURE(between_m);
      CAPTURE(off_north_m);
      REQUIRE(match);
      CHECK((match->p_n - eye).head<2>().norm() < 0.3);  // 5 to 7 m before
    }
}

TEST_CASE("beside a row of equal gables a narrow lens tells how far the row is, and not which gable") {
  constexpr double kPeriod_m = 2.9;
  std::vector<Edge> houses;
  add_box(houses, 0, 10, 240, 12, 12);
  for (int k = -40; k <= 40; ++k) add_box(houses, kPeriod_m * k, 10, 1.6, 12, 13);
  const Vector3d eye(0.4, 0.5, -1.5);
  for (const double off_north_m : {0.5, -1.7, 3.4}) {
    Matcher matcher{City(houses)};
    const auto match =
        matcher.match(seen_from(houses, eye, 52), prior_at(eye + Vector3d(off_north_m, 0.6, 0), 3, 40, 0.3));
    CAPTURE(off_north_m);
    if (!match) continue;  // ambiguous is correct too
    const Eigen::Vector2d off = (match->p_n - eye).head<2>();
    CHECK(std::abs(off.y()) < 0.5);
    CHECK(std::sqrt(match->covariance(0, 0)) > 1.1 * kPeriod_m);  // without neighbours 2.90 m, with them 3.29 and 30
    CHECK(off.dot(match->covariance.ldlt().solve(off)) < 11.83);
    // Across the row the position is still determined.
    CHECK(std::sqrt(match->covariance(1, 1)) < 1.5);
  }
}

TEST_CASE("a picture that agrees with the model nowhere tells no place, and no heading either") {
  Matcher matcher{City(a_street(60))};
  const auto match = matcher.match(seen_from(a_street(6), {2, 1, -1.5}), prior_at(Vector3d(2, 1, -1.5), 10, 20, 1));
  CHECK_FALSE(match);
}
