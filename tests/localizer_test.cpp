// SPDX-License-Identifier: Apache-2.0
//
// The localizer beside the estimator: what its filter and its composer must hold to, by closed forms.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "sdk/host/localizer/composer.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph::localizer {
namespace {

using Eigen::Vector3d;

constexpr int64_t kStart_ns = 1'000'000'000, kFrame_ns = 100'000'000;

odo_fix north_east(int64_t t_ns, const Vector3d& p_n, double sigma_m) {
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, t_ns);
  fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  Vector3d::Map(fix.p_n) = p_n;
  for (const int i : {0, 4, 8}) fix.covariance_n[i] = sigma_m * sigma_m;
  return fix;
}

/// A front-end that states metres and walks 0.1 m forward in each frame.
odo_vo_motion forward(int frame, uint32_t flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_METRIC) {
  auto motion = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, kStart_ns + frame * kFrame_ns);
  motion.header.flags = flags;
  motion.t_from_ns = motion.header.t_ns - kFrame_ns;
  motion.q_c0_c1[0] = 1;
  motion.p_c0_c1[2] = 0.1;
  motion.scale_sigma = 0.01;
  motion.state = ODO_TRACKING;
  return motion;
}

CouplingConfig coupling(CouplingType type) {
  CouplingConfig config;
  config.type = type;
  return config;
}

StartPose given_start() {
  StartPose start;
  start.given = start.heading_given = true;
  return start;
}

void walk(Composer& composer, int from, int to) {
  if (from == 1) composer.update(FrameTime{kStart_ns});
  for (int k = from; k <= to; ++k) {
    const odo_vo_motion motion = forward(k);
    composer.update(FrameTime{motion.header.t_ns});
    composer.update(RelativeMotion{&motion, nullptr});
  }
}

Vector3d position(const Composer& composer) {
  Estimate estimate;
  REQUIRE(composer.at(INT64_MIN, estimate) == ODO_OK);
  return Vector3d(estimate.pose.p_n);
}

}  // namespace

TEST_SUITE("localizer") {
  TEST_CASE("An update is the Kalman filter's, a considered state counts and stays") {
    Localizer localizer;
    localizer.set(kNorth, 1, 4);
    localizer.set(kBarometer, 2, 5);
    Innovation<1> seen;  // of the sum of both
    seen.residual[0] = 3;
    seen.H(0, kNorth) = seen.H(0, kBarometer) = 1;
    seen.noise(0, 0) = 1;
    const auto result = localizer.update(seen, 0, these({kBarometer}));
    CHECK(result.accepted);
    CHECK(std::abs(result.nis - 9.0 / 10) < 1e-12);
    CHECK(std::abs(localizer.x[kNorth] - (1 + 3 * 4.0 / 10)) < 1e-12);
    CHECK(localizer.x[kBarometer] == 2);
    CHECK(std::abs(localizer.P(kNorth, kNorth) - (4 - 16.0 / 10)) < 1e-12);
    CHECK(std::abs(localizer.P(kBarometer, kBarometer) - 5) < 1e-12);
    CHECK(std::abs(localizer.P(kNorth, kBarometer) + 4 * 5 / 10.0) < 1e-12);
  }

  TEST_CASE("A measurement of a time before the drift is weighed without it") {
    Localizer late, early;
    for (Localizer* localizer : {&late, &early}) localizer->set(kNorth, 0, 4);
    Innovation<1> seen;
    seen.residual[0] = 1;
    seen.H(0, kNorth) = 1;
    seen.noise(0, 0) = 2;
    early.update(seen, 0);
    early.add_variance(kNorth, 1.5);
    late.add_variance(kNorth, 1.5);
    seen.since[kNorth] = 1.5;
    late.update(seen, 0);
    CHECK(std::abs(late.x[kNorth] - early.x[kNorth]) < 1e-12);
    CHECK(std::abs(late.P(kNorth, kNorth) - early.P(kNorth, kNorth)) < 1e-12);
  }

  TEST_CASE("A front-end's metres are the track's, from the start that is given") {
    Composer composer(coupling(CouplingType::inertial), given_start(), {true, false});
    walk(composer, 1, 50);
    const Vector3d moved = position(composer);
    CHECK(std::abs(moved.norm() - 5) < 1e-9);
    CHECK(std::holds_alternative<MetricSource>(composer.source()));
  }

  TEST_CASE("A fix that is five seconds old moves the newest pose as one in time would have") {
    Composer in_time(coupling(CouplingType::inertial), given_start(), {true, false});
    Composer late(coupling(CouplingType::inertial), given_start(), {true, false});
    walk(in_time, 1, 100);
    const odo_fix fix = north_east(kStart_ns + 100 * kFrame_ns, position(in_time) + Vector3d(0.3, 0.2, 0), 0.5);
    CHECK(in_time.update(&fix).accepted);
    walk(in_time, 101, 150);
    walk(late, 1, 150);
    CHECK(late.update(&fix).accepted);
    CHECK((position(in_time) - position(late)).norm() < 2e-3);
  }

  TEST_CASE("A fix of a time that the track no longer reaches is refused with a word") {
    Composer composer(coupling(CouplingType::inertial), given_start(), {true, false});
    walk(composer, 1, 1200);
    const odo_fix fix = north_east(kStart_ns + 10 * kFrame_ns, Vector3d(1, 0, 0), 0.5);
    composer.take_notice();
    CHECK_FALSE(composer.update(&fix).accepted);
    CHECK(std::string(composer.take_notice().key) == "late_fix");
  }

  TEST_CASE("A clock that jumps by a hundred years costs no time and is no distance") {
    Composer composer(coupling(CouplingType::inertial), given_start(), {true, false});
    walk(composer, 1, 20);
    const Vector3d before = position(composer);
    constexpr int64_t kYear_ns = 31'557'600'000'000'000;
    auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, kStart_ns + 100 * kYear_ns);
    attitude.q_n_b[0] = 1;
    composer.update(&attitude);
    Estimate after;
    REQUIRE(composer.at(INT64_MIN, after) == ODO_OK);
    CHECK((after.p_n_b - before).norm() < 1);
    CHECK(composer.localizer().P.allFinite());
  }

  TEST_CASE("A held pose goes with a later fix by what it shares with it") {
    Composer composer(coupling(CouplingType::inertial), given_start(), {true, false});
    walk(composer, 1, 100);
    const uint64_t id = composer.hold_pose(kStart_ns + 50 * kFrame_ns);
    HeldPose before, after;
    REQUIRE(composer.held_pose(id, before));
    walk(composer, 101, 150);
    const odo_fix fix = north_east(kStart_ns + 150 * kFrame_ns, position(composer) + Vector3d(0.2, 0.1, 0), 0.1);
    const Vector3d now = position(composer);
    REQUIRE(composer.update(&fix).accepted);
    REQUIRE(composer.held_pose(id, after));
    const double held_m = (after.p_n_b - before.p_n_b).norm(), now_m = (position(composer) - now).norm();
    CHECK(held_m > 0.1 * now_m);
    CHECK(held_m < now_m);
    CHECK(after.own(3, 3) < before.own(3, 3));
  }

  TEST_CASE("By the papers' rules each motion is multiplied by its own scale, horizontally") {
    Composer composer(coupling(CouplingType::paper), given_start(), {true, true});
    composer.update(FrameTime{kStart_ns});
    double expected_m = 0;
    for (int k = 1; k <= 30; ++k) {
      const odo_vo_motion motion = forward(k, ODO_VO_ROTATION | ODO_VO_TRANSLATION);
      auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, motion.header.t_ns);
      scale.header.flags = ODO_SCALE_HORIZONTAL;
      scale.scale = 1 + 0.1 * (k % 3);
      scale.sigma = 0.05;
      expected_m += 0.1 * scale.scale;
      composer.update(FrameTime{motion.header.t_ns});
      composer.update(RelativeMotion{&motion, &scale});
    }
    CHECK(std::abs(position(composer).norm() - expected_m) < 1e-9);
    CHECK(std::abs(composer.distance_m() - expected_m) < 1e-9);
  }
}

}  // namespace odograph::localizer
