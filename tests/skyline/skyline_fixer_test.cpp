// SPDX-License-Identifier: Apache-2.0
//
// When a picture gets a fix: poses, intervals, drift, failures, delay.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "plugins/fix/skyline/skyline_fixer.hpp"
#include "tests/skyline/rendered_street.hpp"
#include "tests/support/support.hpp"

using namespace odograph;
using namespace odograph::skyline;
using namespace odograph::skyline::test;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("skyline_fixer");

namespace {

constexpr int64_t kSecond = 1'000'000'000;
const Vector3d kPlace(3.2, -1.7, -1.5);

/// A fixer for an upward camera in a street, with a picture from kPlace and one in which nothing is seen.
struct Street {
  TemporaryFolder folder;
  std::optional<SkylineFixer> fixer;
  cv::Mat seen = view_upwards(kPlace), blank{480, 640, CV_8UC1, cv::Scalar(70)};

  explicit Street(FixerConfig config = {}, const std::vector<double>& roofs = {}) {
    write_street(folder / "city.json", roofs);
    config.model = (folder / "city.json").string(), config.min_agreement = roofs.empty() ? 0.6 : 0.75;
    cv::randu(blank, 0, 90);
    fixer.emplace(config);
  }

  static PipelinePose pose(int64_t t_ns, const Vector3d& p_n = kPlace, double sigma_m = 1) {
    PipelinePose p{t_ns, p_n, Eigen::Quaterniond(0, 1, 0, 0)};
    p.has_position = p.is_of_camera = p.is_metric = true;
    p.horizontal_sigma_m = sigma_m, p.yaw_sigma_rad = 0.02, p.tilt_sigma_rad = 0.01;
    return p;
  }

  std::vector<Outcome> add(int64_t t_ns, const cv::Mat& picture) {
    CHECK(fixer->advance(t_ns).empty());
    REQUIRE_FALSE(fixer->busy());
    REQUIRE(fixer->is_due(t_ns));
    return fixer->add_picture({.t_ns = t_ns, .grey = picture, .mask = {}, .chroma = {}, .lens = kLens});
  }

  /// What becomes of the picture in processing, at frames that follow each other in 50 ms.
  Outcome finish(int64_t t_ns) {
    while (fixer->busy())
      if (const auto done = fixer->advance(t_ns += kSecond / 20); !done.empty()) return done.front();
    FAIL("no outcome");
    return Rejection{};
  }

  /// The same for a picture that comes with its pose.
  Outcome fix(const PipelinePose& pose, const cv::Mat& picture) {
    CHECK(fixer->add_pose(pose).empty());
    const auto at_once = add(pose.t_ns, picture);
    return at_once.empty() ? finish(pose.t_ns) : at_once.front();
  }
};

std::string reason_of(const Outcome& outcome) {
  const auto* rejection = std::get_if<Rejection>(&outcome);
  return rejection ? kReasonNames[rejection->first] : "none";
}

}  // namespace

TEST_CASE("a picture waits for its pose, and the next one is due after the interval") {
  Street street({.min_sigma = 3});
  CHECK(street.add(kSecond, street.seen).empty());
  CHECK_FALSE(street.fixer->is_due(kSecond + 498'000'000));
  CHECK(street.fixer->is_due(kSecond + 500'000'000));
  CHECK(street.fixer->add_pose(Street::pose(kSecond - 10'000'000)).empty());
  CHECK_FALSE(street.fixer->busy());
  CHECK(street.fixer->add_pose(Street::pose(kSecond)).empty());
  CHECK(street.fixer->busy());
  const Outcome outcome = street.finish(kSecond);
  const Fix* fix = std::get_if<Fix>(&outcome);
  REQUIRE(fix);
  CHECK(fix->t_ns == kSecond);
  CHECK(fix->has_slant);
  CHECK_FALSE(fix->has_height);
  CHECK((fix->match.p_n - kPlace).head<2>().norm() < 0.6);
  CHECK(fix->match.covariance.diagonal().minCoeff() > 3 * 3);
  CHECK(fix->match.second_best_ratio >= 0.01);
}

TEST_CASE("a picture without a pose of the camera at its time gets no fix, and a later one replaces it") {
  Street street;
  CHECK(street.add(kSecond, street.seen).empty());
  const auto replaced = street.add(2 * kSecond, street.seen);
  REQUIRE(replaced.size() == 1);
  CHECK(reason_of(replaced[0]) == "prior");
  const auto passed = street.fixer->add_pose(Street::pose(2 * kSecond + 1));
  REQUIRE(passed.size() == 1);
  CHECK(reason_of(passed[0]) == "prior");
  auto of_body = Street::pose(3 * kSecond);
  of_body.is_of_camera = false;
  CHECK(reason_of(street.fix(of_body, street.seen)) == "prior");
  CHECK(reason_of(street.fix(Street::pose(4 * kSecond), street.blank)) == "sky");
}

TEST_CASE(
    "a pose that is off by more than the search radius is not matched: by its sigma, or by the path since a fix") {
  Street street;
  const auto reason_at = [&](int64_t t_ns, double sigma_m, double path_m) {
    auto pose = Street::pose(t_ns, kPlace, sigma_m);
    pose.path_m = path_m;
    return reason_of(street.fix(pose, street.seen));
  };
  CHECK(reason_at(kSecond, 1001, 0) == "prior");
  CHECK(reason_at(2 * kSecond, 13.4, 0) == "prior");  // three sigmas are 40.2 m
  CHECK(reason_at(3 * kSecond, 1, 670) == "prior");   // 670 m with a heading sigma of 0.02: three sigmas are 40.2 m
  CHECK(reason_at(4 * kSecond, 1, 660) == "none");
  CHECK(reason_at(6 * kSecond, 1, 1325) == "none");  // 665 m after the fix
}

TEST_CASE("a fix that comes too late for the estimators refers to the newest pose") {
  Street street;
  CHECK(street.fixer->add_pose(Street::pose(kSecond)).empty());
  CHECK(street.add(kSecond, street.seen).empty());
  const Vector3d walked(3, -4, 0);
  CHECK(street.fixer->add_pose(Street::pose(3 * kSecond + 600'000'000, kPlace + walked)).empty());
  const Outcome outcome = street.finish(3 * kSecond + 600'000'000);
  const Fix* fix = std::get_if<Fix>(&outcome);
  REQUIRE(fix);
  CHECK(fix->t_ns == 3 * kSecond + 600'000'000);
  CHECK_FALSE(fix->has_slant);
  CHECK((fix->match.p_n - kPlace - walked).head<2>().norm() < 0.8);
}

TEST_CASE("a pose that is off by more than its sigma is searched for after four failures") {
  Street street({.radius = 20});
  const Vector3d off = kPlace + Vector3d(-13, 9, 0);
  int failures = 0;
  for (; failures < 12; ++failures) {
    const Outcome outcome = street.fix(Street::pose((1 + failures) * kSecond, off, 0.2), street.seen);
    if (const Fix* fix = std::get_if<Fix>(&outcome)) {
      CHECK((fix->match.p_n - kPlace).head<2>().norm() < 0.6);
      break;
    }
    const auto& text = std::get<Rejection>(outcome).second;
    CAPTURE(failures);
    CHECK_MESSAGE((text == "lost: more pictures must agree") == (failures >= 4), text);
  }
  CHECK(failures > 4);
  CHECK(failures < 12);
}

TEST_CASE("where the model's roofs are metres off they are surveyed, and the next pictures fit the corrected model") {
  Street street({}, {3.5, -4, 3, -4, 3.5, -3});
  int second = 0;
  const auto fix_at = [&](const Vector3d& place) {
    return street.fix(Street::pose(2 * ++second * kSecond, place + Vector3d(0.8, -0.5, 0)), view_upwards(place));
  };
  CHECK(reason_of(fix_at(kPlace)) == "agreement");
  const Outcome outcome = fix_at(kPlace);
  const Fix* surveyed = std::get_if<Fix>(&outcome);
  REQUIRE(surveyed);
  CHECK(surveyed->match.roofs.size() == std::size(kStreet));
  CHECK((surveyed->match.p_n - kPlace).head<2>().norm() < 0.5);
  for (int k = 1; k < 6; ++k) {
    const Vector3d place = kPlace + k * Vector3d(0.5, 0.1, 0);
    const Outcome later = fix_at(place);
    CAPTURE(k);
    CAPTURE(reason_of(later));
    const Fix* fix = std::get_if<Fix>(&later);
    REQUIRE(fix);
    CHECK(fix->match.roofs.empty());
    CHECK((fix->match.p_n - place).head<2>().norm() < 0.5);
  }
}

TEST_CASE("a survey from a pose that is off by more than its sigma finds the place or none") {
  for (const Vector3d& off : {Vector3d(-8, 0, 0), Vector3d(7, -7, 0), Vector3d(-10, 4, 0), Vector3d(2, 12, 0)}) {
    CAPTURE(off.transpose());
    Street street({}, {0, 0, 0, 0, 0, 0});
    for (int second = 1; second <= 5; ++second) {
      const Outcome outcome = street.fix(Street::pose(second * kSecond, kPlace + off, 0.3), street.seen);
      const Fix* fix = std::get_if<Fix>(&outcome);
      if (fix && !fix->match.roofs.empty()) CHECK((fix->match.p_n - kPlace).head<2>().norm() < 1);
    }
  }
}

TEST_CASE("a pose without an uncertainty is surveyed like another") {
  for (const double yaw_sigma : {0.0, 3.0}) {
    CAPTURE(yaw_sigma);
    Street street({}, {3.5, -4, 3, -4, 3.5, -3});
    bool fixed = false;
    for (int k = 1; k <= 3; ++k) {
      auto pose = Street::pose(2 * k * kSecond, kPlace, 0);
      pose.yaw_sigma_rad = yaw_sigma;
      const Outcome outcome = street.fix(pose, street.seen);
      const Fix* fix = std::get_if<Fix>(&outcome);
      if (!fix) continue;
      fixed = true;
      CHECK((fix->match.p_n - kPlace).head<2>().norm() < 0.5);
    }
    CHECK(fixed);
  }
}

TEST_CASE("without a survey a model whose roofs are metres off gives no fix") {
  Street street({.survey = false}, {3.5, -4, 3, -4, 3.5, -3});
  for (int second = 2; second < 10; second += 2) {
    const Outcome outcome = street.fix(Street::pose(second * kSecond, kPlace + Vector3d(0.8, -0.5, 0)), street.seen);
    CHECK(std::holds_alternative<Rejection>(outcome));
  }
}

TEST_CASE("without a city there is no fixer, nor without a database where it is needed or the model must be geodetic") {
  CHECK_THROWS_WITH(SkylineFixer{FixerConfig{}},
                    "model: expected a CityJSON or CityGML file of the city, or a database in `skylines`");
  FixerConfig config;
  config.model = "city.json", config.start_known = false;
  CHECK_THROWS_WITH(SkylineFixer{config}, "start_known: false wants a database in `skylines`");
  config.skylines = "city.skylines", config.geodetic = true;
  CHECK_THROWS_WITH(SkylineFixer{config}, "geodetic: a database lies along the model's grid; give model_origin");
}

TEST_SUITE_END();
