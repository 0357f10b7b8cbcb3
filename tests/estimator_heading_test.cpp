// SPDX-License-Identifier: Apache-2.0
//
// Headings that are off by more than a small angle, and who hears of a world that rotates.
#include <doctest/doctest.h>

#include <string>

#include "tests/estimator_walk.hpp"

using namespace odograph;
using namespace odograph::inertial;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("estimator");

namespace {

constexpr double kOff_rad = 0.45;

InertialEstimator an_estimator() {
  CouplingConfig config;
  config.type = CouplingType::inertial;
  return InertialEstimator(config, {}, {true, false});
}

double heading_of(const Quaterniond& q) { return 2 * std::atan2(q.z(), q.w()); }

}  // namespace

TEST_CASE("a heading that is mended by much moves positions, velocity, clones and held poses along arcs") {
  ErrorState e;
  e.reset();
  constexpr double kVariance = 0.3 * 0.3, kSpeed = 1.5;
  e.x.v_n = Vector3d(kSpeed, 0, 0);
  e.set_independent(kTheta + 2, kVariance);
  e.P(kVelocity + 1, kVelocity + 1) = kSpeed * kSpeed * kVariance;  // the velocity turns with the heading
  e.P(kVelocity + 1, kTheta + 2) = e.P(kTheta + 2, kVelocity + 1) = kSpeed * kVariance;
  uint64_t id = 0;
  double gone_m = 0, held_at_m = 0;
  for (int i = 0; i < 200; ++i) {
    ImuTransition by;
    by.add(Eigen::Matrix3d::Identity(), Vector3d::Zero(), 0.1);
    e.x.p_n += 0.1 * e.x.v_n, gone_m += 0.1 * kSpeed;
    e.propagate(by, {});
    if (i == 100) {
      held_at_m = gone_m;
      id = e.hold({e.x.q_n_b, e.x.p_n, kTheta, kTheta, 1}, i, gone_m);
    }
  }
  e.clone(200);
  Innovation<1> heading;
  heading.residual[0] = kOff_rad;
  heading.by_one(kTheta + 2, Eigen::Matrix<double, 1, 1>::Ones());
  heading.noise(0, 0) = 1e-8;
  REQUIRE(e.update_heading(heading, 0).accepted);
  const Vector3d ahead(std::cos(kOff_rad), std::sin(kOff_rad), 0);
  CHECK(e.x.p_n.isApprox(gone_m * ahead, 1e-5));
  CHECK(e.x.v_n.isApprox(kSpeed * ahead, 1e-5));
  CHECK(e.clone_back(0).p_n.isApprox(gone_m * ahead, 1e-5));
  HeldPose held;
  REQUIRE(e.held(id, held));
  CHECK(held.p_n_b.isApprox(held_at_m * ahead, 1e-5));
  CHECK(heading_of(e.x.q_n_b) == doctest::Approx(kOff_rad).epsilon(1e-5));
}

TEST_CASE("one fix with its heading puts a walk right that a compass had led astray, and the metre stays") {
  for (const uint64_t seed : {1, 2, 3}) {
    WalkMeasurements what;
    what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.005;
    what.compass_sigma_rad = 0.3;
    what.compass_rad = [](double) { return -kOff_rad; };
    what.fix_every_s = 50, what.fix_sigma_m = 0.2, what.end_s = 60;
    std::optional<EstimatorWalk> walk;
    what.change_fix = [&](double t_s, odo_fix& fix) {
      fix.header.flags |= ODO_FIX_ORIENTATION | ODO_FIX_ORIENTATION_COVARIANCE;
      const auto T = walk->truth(t_s);
      const Quaterniond q = T.q_n_c * Quaterniond(0, 1, 0, 0).conjugate();  // of the body
      fix.q_n_b[0] = q.w(), fix.q_n_b[1] = q.x(), fix.q_n_b[2] = q.y(), fix.q_n_b[3] = q.z();
      for (const int i : {0, 4, 8}) fix.orientation_cov_n[i] = 0.01 * 0.01;
    };
    walk.emplace(estimator_scenario(80), what, seed);
    auto estimator = an_estimator();
    double before_m = 0, after_m = 0, after_rad = 0, before_scale = 0, after_scale = 0;
    walk->run(estimator, [&](double t_s, const odo_pose& pose) {
      const auto truth = walk->truth(t_s);
      const double off_m = (Vector3d(pose.p_n) - truth.p_n_c).head<2>().norm();
      if (t_s < 50) {
        before_m = off_m, before_scale = pose.scale;
      } else if (t_s > 51) {
        after_m = std::max(after_m, off_m), after_scale = pose.scale;
        after_rad = std::max(after_rad, quaternion(pose.q_n).angularDistance(truth.q_n_c));
      }
    });
    CAPTURE(seed);
    CHECK(before_m > 15);
    CHECK(after_m < 1.0);
    CHECK(after_rad < 0.05);
    CHECK(after_scale == doctest::Approx(before_scale).epsilon(0.01));
  }
}

TEST_CASE("a compass that turns the world of a camera announces it, however little each time") {
  WalkMeasurements what;
  what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.005;
  what.compass_sigma_rad = 0.1, what.end_s = 60;
  what.compass_rad = [](double t_s) { return t_s < 20 ? 0.0 : 0.3; };
  EstimatorWalk walk(estimator_scenario(80), what, 4);
  auto estimator = an_estimator();
  double off_rad = 0, announced_rad = 0, first_rad = 0;
  bool first = true;
  walk.run(
      estimator,
      [&](double t_s, const odo_pose& pose) {
        if (t_s < 19) return;
        off_rad = heading_of(quaternion(pose.q_n) * walk.truth(t_s).q_n_c.conjugate());
        if (std::exchange(first, false)) first_rad = off_rad, announced_rad = 0;
      },
      [&](const Correction& correction, const odo_pose&) { announced_rad += heading_of(correction.q); });
  CHECK(off_rad - first_rad > 0.02);
  CHECK(std::abs(announced_rad - (off_rad - first_rad)) < 0.2 * (off_rad - first_rad));
}

TEST_CASE("a fix that comes later than the clones reach back is refused, and told") {
  WalkMeasurements what;
  what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.005;
  what.end_s = 20;
  EstimatorWalk walk(estimator_scenario(80), what, 5);
  auto estimator = an_estimator();
  walk.run(estimator, [](double, const odo_pose&) {});
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, EstimatorWalk::ns(19));
  fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  fix.covariance_n[0] = fix.covariance_n[4] = 100;
  CHECK(estimator.update(&fix).accepted);
  CHECK(estimator.take_notice().key == nullptr);
  fix.header.t_ns = EstimatorWalk::ns(10);
  CHECK_FALSE(estimator.update(&fix).accepted);
  CHECK(std::string(estimator.take_notice().key) == "late_fix");
  CHECK(estimator.take_notice().key == nullptr);
}

TEST_CASE(
    "where a track's heading is doubted its north goes along: what a compass tells of the body is as sure as before") {
  ErrorState e;
  e.reset();
  e.set_independent(kTheta + 2, 0.01);
  e.set_independent(kNorth, 0.04);
  // A compass sees the body's heading less its own error: theta + north.
  const auto compass = [&] { return e.P(kTheta + 2, kTheta + 2) + e.P(kNorth, kNorth) + 2 * e.P(kTheta + 2, kNorth); };
  const double before = compass();
  e.loosen_heading(0.5);
  CHECK(e.P(kTheta + 2, kTheta + 2) == doctest::Approx(0.01 + 0.25));
  CHECK(e.P(kNorth, kNorth) == doctest::Approx(0.04 + 0.25));
  CHECK(compass() == doctest::Approx(before));
}

TEST_CASE("without a camera a walk goes astray with its compass, by as much as it says") {
  Parameters p;
  p.step_heading_sigma_rad = 0.02, p.step_heading_walk = 0;  // the phone's direction is known, north is not
  constexpr double kCompass_rad = 0.2;
  double squares = 0, across_m = 0;
  constexpr int kWalks = 30;
  for (uint64_t seed = 1; seed <= kWalks; ++seed) {
    const double off_rad = kCompass_rad * Random(seed, 9).normal();
    WalkMeasurements what;
    what.camera = false;
    what.compass_sigma_rad = kCompass_rad;
    what.compass_rad = [&](double) { return off_rad; };
    what.step_factor_sigma = 0.02, what.step_heading_rad = 0.02, what.step_offset_rad = 0.02;
    what.change_step = [&](double, odo_step& step) { step.heading_rad += off_rad; };
    Scenario straight;
    straight.route = {{0, 0, 0}, {40, 0, 0}};
    EstimatorWalk walk(straight, what, seed);
    CouplingConfig config;
    config.type = CouplingType::inertial;
    InertialEstimator estimator(config, {}, {false, false}, p);
    odo_pose last{};
    double last_s = 0, from_m = 0;
    bool begun = false;
    walk.run(estimator, [&](double t_s, const odo_pose& pose) {
      if (!std::exchange(begun, true)) from_m = walk.truth(t_s).p_n_c.y() - pose.p_n[1];
      last = pose, last_s = t_s;
    });
    const double error_m = last.p_n[1] + from_m - walk.truth(last_s).p_n_c.y();
    squares += error_m * error_m / last.covariance[4 * 6 + 4] / kWalks;
    across_m += std::abs(error_m) / kWalks;
  }
  MESSAGE(across_m << " m across the path in the mean, NEES " << squares);
  CHECK(across_m > 3);
  CHECK(squares > 0.8);  // 1.28; 19 where the steps' direction does not err with the compass
  CHECK(squares < 1.7);
}

TEST_SUITE_END();
