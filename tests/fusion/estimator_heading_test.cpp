// SPDX-License-Identifier: Apache-2.0
//
// Heading errors beyond a small angle, and announcements of a rotated world.
#include "sdk/host/fusion/heading.hpp"
#include "tests/support/measured_walk.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("estimator");

namespace {

constexpr double kOff_rad = 0.45;

CouplingConfig coupling() {
  CouplingConfig config{.type = CouplingType::localizer};
  return config;
}

double heading_of(const Quaterniond& q) { return 2 * std::atan2(q.z(), q.w()); }

}  // namespace

TEST_CASE("one fix with heading corrects a walk misled by a compass, and keeps the metric scale") {
  for (const uint64_t seed : {1, 2, 3}) {
    WalkMeasurements what;
    what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.005;
    what.compass_sigma_rad = 0.3;
    what.compass_rad = [](double) { return -kOff_rad; };
    what.fix_every_s = 50, what.fix_sigma_m = 0.2, what.end_s = 60;
    std::optional<MeasuredWalk> walk;
    what.change_fix = [&](double t_s, odo_fix& fix) {
      fix.header.flags |= ODO_FIX_ORIENTATION | ODO_FIX_ORIENTATION_COVARIANCE;
      const auto T = walk->truth(t_s);
      const Quaterniond q = T.q_n_c * Quaterniond(0, 1, 0, 0).conjugate();  // of the body
      fix.q_n_b[0] = q.w(), fix.q_n_b[1] = q.x(), fix.q_n_b[2] = q.y(), fix.q_n_b[3] = q.z();
      for (const int i : {0, 4, 8}) fix.orientation_cov_n[i] = 0.01 * 0.01;
    };
    walk.emplace(walk_scenario(80), what, seed);
    TestFusion fusion(coupling(), {}, {true, false});
    double before_m = 0, after_m = 0, after_rad = 0, before_scale = 0, after_scale = 0;
    walk->run(fusion, [&](double t_s, const odo_pose& pose) {
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

TEST_CASE("a compass that rotates a camera's world announces it, however small each rotation") {
  WalkMeasurements what;
  what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.005;
  what.compass_sigma_rad = 0.1, what.end_s = 60;
  what.compass_rad = [](double t_s) { return t_s < 20 ? 0.0 : 0.3; };
  MeasuredWalk walk(walk_scenario(80), what, 4);
  TestFusion fusion(coupling(), {}, {true, false});
  double off_rad = 0, announced_rad = 0, first_rad = 0;
  bool first = true;
  walk.run(
      fusion,
      [&](double t_s, const odo_pose& pose) {
        if (t_s < 19) return;
        off_rad = heading_of(quaternion(pose.q_n) * walk.truth(t_s).q_n_c.conjugate());
        if (std::exchange(first, false)) first_rad = off_rad, announced_rad = 0;
      },
      [&](const Correction& correction, const odo_pose&) { announced_rad += heading_of(correction.q); });
  CHECK(off_rad - first_rad > 0.02);
  CHECK(std::abs(announced_rad - (off_rad - first_rad)) < 0.2 * (off_rad - first_rad));
}

TEST_CASE("a compass for the start alone does not rotate a camera's world, not after blind frames either") {
  for (const auto type : {CouplingType::paper, CouplingType::localizer}) {
    WalkMeasurements what;
    what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.005;
    what.odometry.blind_from_s = 30, what.odometry.blind_to_s = 30.1;
    what.compass_sigma_rad = 0.1, what.end_s = 60;
    what.compass_rad = [](double t_s) { return t_s < 20 ? 0.0 : 0.3; };
    double turned_rad[2] = {};
    for (const auto compass : {Compass::always, Compass::start}) {
      MeasuredWalk walk(walk_scenario(80), what, 4);
      TestFusion fusion({.compass = compass, .type = type}, {}, {true, false});
      double before_rad = 0, off_rad = 0;
      walk.run(fusion, [&](double t_s, const odo_pose& pose) {
        off_rad = heading_of(quaternion(pose.q_n) * walk.truth(t_s).q_n_c.conjugate());
        if (t_s < 19) before_rad = off_rad;
      });
      turned_rad[static_cast<size_t>(compass)] = off_rad - before_rad;
    }
    CHECK(turned_rad[0] > 0.02);
    CHECK(std::abs(turned_rad[1]) < 0.005);
  }
}

TEST_CASE("a heading without north states the drift of a gyroscope whose bias is known to 0.02 degrees a second") {
  PoseFilter filter;
  Heading heading;
  heading.start(filter);
  for (int i = 0; i < 300; ++i) heading.propagate(filter, 1, true);
  const double off_rad = 300 * 0.02 * EIGEN_PI / 180;
  CHECK(3 * filter.sigma(kHeading) > off_rad);
  CHECK(filter.sigma(kHeading) < off_rad);
}

TEST_CASE("without a camera a walk drifts with its compass heading, consistently with its covariance") {
  constexpr double kCompass_rad = 0.2;
  double squares = 0, across_m = 0;
  constexpr int kWalks = 30;
  for (uint64_t seed = 1; seed <= kWalks; ++seed) {
    const double off_rad = kCompass_rad * Random(seed, 9).normal();
    WalkMeasurements what{.camera = false, .compass_sigma_rad = kCompass_rad};
    what.compass_rad = [&](double) { return off_rad; };
    what.step_factor_sigma = 0.02, what.step_heading_rad = 0.02, what.step_offset_rad = 0.02;
    what.change_step = [&](double, odo_step& step) { step.heading_rad += off_rad; };
    Scenario straight;
    straight.route = {{0, 0, 0}, {40, 0, 0}};
    MeasuredWalk walk(straight, what, seed);
    TestFusion fusion({.type = CouplingType::localizer}, {}, {false, false});
    odo_pose last{};
    double last_s = 0, from_m = 0;
    bool begun = false;
    walk.run(fusion, [&](double t_s, const odo_pose& pose) {
      if (!std::exchange(begun, true)) from_m = walk.truth(t_s).p_n_c.y() - pose.p_n[1];
      last = pose, last_s = t_s;
    });
    const double error_m = last.p_n[1] + from_m - walk.truth(last_s).p_n_c.y();
    squares += error_m * error_m / last.covariance[4 * 6 + 4] / kWalks;
    across_m += std::abs(error_m) / kWalks;
  }
  MESSAGE(across_m << " m across the path in the mean, NEES " << squares);
  CHECK(across_m > 3);
  CHECK(squares == Between{0.2, 1.7});  // the phone's direction has a sigma of 0.3 rad, and is exact here
}
