// SPDX-License-Identifier: Apache-2.0
//
// Pictures with a narrow view each, matched jointly along a path.
#include "plugins/fix/skyline/validate_match.hpp"
#include "plugins/fix/skyline/picture_job.hpp"
#include "plugins/fix/skyline/view_window.hpp"
#include "tests/skyline/skyline_streets.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using namespace odograph::skyline::test;
using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("skyline_path");

namespace {

const Quaterniond kLevel(0, 1, 0, 0);

Quaterniond about_down(double rad) { return Quaterniond(AngleAxisd(rad, Vector3d::UnitZ())); }

/// A walk of 16 m along the street with a camera of 63 degrees that faces ahead and the houses alternately. Then the
/// whole track is rotated about its newest place and moved, as by an odometry with a heading error.
struct Walk {
  std::vector<Edge> houses = a_street(16);
  std::vector<View> older;
  std::vector<SkyEdge> newest;
  Vector3d place{1.3, -0.8, -1.5};
  Prior prior{};

  Walk(double turned_rad, const Vector3d& moved_n) {
    const Quaterniond rotation = about_down(turned_rad);
    const double towards_deg[] = {-30, 5, 40, -10, 20, -40, 30, 0, 15};
    const auto seen = [&](const Vector3d& p_n, double towards) {
      return seen_from(houses, p_n, kLevel, 4, towards - 31.5, towards + 31.5);
    };
    for (int i = 0; i < 8; ++i) {
      const Vector3d p_n = place + Vector3d(2.0 * (i - 8), 0.3 * (i % 2), 0);
      older.push_back({seen(p_n, towards_deg[i]), place + moved_n + rotation * (p_n - place), rotation * kLevel});
    }
    newest = seen(place, towards_deg[8]);
    prior = {place + moved_n, rotation * kLevel, 4, 4 * kDegree, 0.6 * kDegree, 40};
  }
};

}  // namespace

TEST_CASE("nine narrow pictures tell the place and the heading that one of them does not") {
  const Walk walk(6 * kDegree, {3.1, -4.4, 0});
  Matcher matcher{City(walk.houses)};
  CHECK_FALSE(matcher.match(walk.newest, walk.prior));
  CHECK(matcher.refusal() == Refusal::few_edges);
  const auto match = required(matcher.match(walk.newest, walk.prior, nullptr, walk.older));
  CHECK((match->p_n - walk.place).head<2>().norm() < 0.3);
  CHECK(match->q_n_c.angularDistance(kLevel) < 0.5 * kDegree);
  CHECK(match->agreement > 0.9);
  CHECK(match->second_best_ratio < 1e-6);
  CHECK((match->p_n - walk.place).head<2>().norm() < 3 * std::sqrt(match->covariance.trace()));
}

TEST_CASE("pictures of another street are not taken for this one") {
  Walk walk(2 * kDegree, {1, 1, 0});
  std::vector<Edge> other;
  for (int i = 0; i < 7; ++i) add_box(other, -60 + 19.0 * i, i % 2 ? 22 : -19, 9 + i, 13, 7 + 2.5 * (i % 4));
  Matcher matcher{City(other)};
  const auto match = matcher.match(walk.newest, walk.prior, nullptr, walk.older);
  PathMatchValidator validator;
  const auto is_rejected = [&] {
    return !match || validator.validate(*match, walk.prior.p_n, walk.prior.q_n_c, 0.75).has_value();
  };
  CHECK(is_rejected());
}

TEST_CASE("the skyline of a sector is the whole one's there, and nothing elsewhere") {
  City city(a_street(16));
  const Vector3d eye(2, 1, -1.5);
  city.select_edges(eye, 10, 0.05);
  Horizon all, part;
  city.quick_horizon(eye, all);
  const auto sector = Sector::between(300 * kDegree, 400 * kDegree);  // through north
  city.quick_horizon(eye, part, sector);
  CHECK(city.quick_work(sector) < city.quick_work() / 1.7);
  for (size_t j = 0; j < Horizon::kDirections; ++j) {
    const bool inside = j >= 600 || j < 80;
    if (inside) CHECK(part.elevation[j] == all.elevation[j]);
    if (j >= 90 && j < 590) CHECK(part.elevation[j] == 0);
  }
  CHECK(Sector::between(0, 7).blocks == Sector::kBlocks);
}

TEST_CASE("the window keeps the newest pictures that lie apart or look elsewhere, and follows corrections") {
  ViewWindow window;
  const auto at = [](double north_m) { return View{{}, Vector3d(north_m, 0, 0), kLevel}; };
  CHECK(window.adds_information({0, 0, 0}, kLevel));
  window.add(at(0), 0);
  CHECK_FALSE(window.adds_information({1.9, 0, 0}, kLevel));
  CHECK(window.adds_information({2.1, 0, 0}, kLevel));
  CHECK(window.adds_information({0, 0, 0}, about_down(0.6) * kLevel));
  for (int i = 1; i <= 11; ++i) window.add(at(2.1 * i), 2.1 * i);
  CHECK(window.views().size() == 10);
  CHECK(window.views().front().p_n.x() == doctest::Approx(4.2));
  Match match{.p_n = Vector3d::Zero(), .q_n_c = kLevel, .landmark_n = Vector3d::Zero()};
  match.covariance = 0.09 * Eigen::Matrix2d::Identity(), match.yaw_sigma_rad = 0.01;
  Match again = match;
  window.inflate_covariance(match, 0.02);  // of 18.9 m
  CHECK(match.covariance(0, 0) == doctest::Approx(0.09 + 0.189 * 0.189));
  // A roof at 10 m is seen in another direction from a place that is off: the heading is no surer than that.
  CHECK(match.yaw_sigma_rad == doctest::Approx(std::hypot(0.01, std::sqrt(match.covariance(0, 0)) / 10)));
  window.add(at(25.2), 25.2), window.add(at(27.3), 27.3);
  window.inflate_covariance(again, 0.02);  // two of ten are new
  CHECK(again.covariance(1, 1) == doctest::Approx(5 * match.covariance(1, 1)));
  CHECK(again.yaw_sigma_rad == doctest::Approx(std::sqrt(5) * match.yaw_sigma_rad));
  window.correct(about_down(0.5 * std::numbers::pi), {0, 0, 1});
  CHECK(window.views().back().p_n.isApprox(Vector3d(0, 27.3, 1), 1e-9));
  CHECK(window.views().back().q_n_c.angularDistance(about_down(0.5 * std::numbers::pi) * kLevel) < 1e-9);
  window.add(at(66), 66);
  CHECK(window.views().size() == 2);  // the one at 27.3 m is 38.7 m back, the one before it 40.8
}

TEST_CASE("a path in which few directions agree must be told twice, whatever n is meanwhile") {
  const Vector3d thought(10, 5, -1.5);
  const Quaterniond rotation = about_down(0.1);
  Match match{.landmark_n = Vector3d::Zero()};
  match.p_n = Vector3d(12, 4, -1.5), match.q_n_c = rotation * kLevel, match.agreement = 0.5;
  PathMatchValidator validator;
  SUBCASE("the same offset again") {
    CHECK(validator.validate(match, thought, kLevel, 0.75));
    // n is corrected meanwhile, so that the prior at x is at C x now, and the walker goes on.
    const Quaterniond q = about_down(-0.3);
    const Vector3d p(3, -2, 0), on(4, 1, 0);
    validator.correct(q, p);
    match.p_n += rotation * on;
    CHECK_FALSE(validator.validate(match, q * (thought + on) + p, q * kLevel, 0.75));
  }
  SUBCASE("another place") {
    CHECK(validator.validate(match, thought, kLevel, 0.75));
    match.p_n.x() += 2.5;
    CHECK(validator.validate(match, thought, kLevel, 0.75));
  }
  SUBCASE("another heading") {
    CHECK(validator.validate(match, thought, kLevel, 0.75));
    match.q_n_c = about_down(0.2) * kLevel;
    CHECK(validator.validate(match, thought, kLevel, 0.75));
  }
  SUBCASE("many agree: once is enough") {
    match.agreement = 0.8;
    CHECK_FALSE(validator.validate(match, thought, kLevel, 0.75));
  }
  SUBCASE("too few agree, or another place is likely") {
    match.agreement = 0.3;
    CHECK(validator.validate(match, thought, kLevel, 0.75)->first == kAgreement);
    match.agreement = 0.9, match.second_best_ratio = 1e-5;
    CHECK(validator.validate(match, thought, kLevel, 0.75)->first == kAmbiguity);
  }
}

TEST_CASE("a match that comes late is carried on by the odometry's displacement since, with its doubt") {
  PictureJob job;
  job.q_n_c = kLevel;
  job.prior.q_n_c = about_down(1.2) * kLevel;  // as found in a database without an initial position
  job.p_n = Vector3d(1, 2, -1.5);
  Match match{.landmark_n = Vector3d::Zero()};
  match.p_n = Vector3d(5, 5, -1.5), match.q_n_c = about_down(0.5 * std::numbers::pi) * kLevel;
  match.yaw_sigma_rad = 0.02, match.covariance = 0.01 * Eigen::Matrix2d::Identity();
  job.match = match;
  job.correct(about_down(0.25), {7, 0, 0});  // correction of n since the picture
  // The walker has gone on by 10 m to the estimated north, and has rotated by 0.3 rad.
  const Vector3d now_n = job.corrected(Vector3d(1, 2, -1.5)) + about_down(0.25) * Vector3d(10, 0, 0);
  const Match later = job.propagated_to(now_n, about_down(0.25 + 0.3) * kLevel, 0.01);
  CHECK(later.p_n.isApprox(Vector3d(5, 15, -1.5), 1e-9));
  CHECK(later.q_n_c.angularDistance(about_down(0.5 * std::numbers::pi + 0.3) * kLevel) < 1e-6);
  CHECK(later.covariance(1, 1) == doctest::Approx(0.01 + 0.01));         // along: 1 % of 10 m
  CHECK(later.covariance(0, 0) == doctest::Approx(0.01 + 0.01 + 0.04));  // across: 0.02 rad of 10 m too
}
