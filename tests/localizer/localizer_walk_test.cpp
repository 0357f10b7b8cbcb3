// SPDX-License-Identifier: Apache-2.0
//
// The localizer on simulated measurements of a front-end, steps and fixes: accuracy and consistency.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdk/host/localizer/composer.hpp"
#include "tests/support/measured_walk.hpp"

namespace odograph {
namespace {

using Eigen::Matrix2d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kSeeds = 8;

struct Outcome {
  double rms_m = 0;       ///< of the position relative to the first one
  double worst_nees = 0;  ///< largest over the seeds, of the horizontal position, mean of the second half
  double mean_nees = 0;
};

/// Over several walks. `absolute`: positions are compared in n, otherwise relative to the first one.
Outcome run(const WalkMeasurements& what, double length_m, bool absolute) {
  Outcome out;
  for (uint64_t seed = 51; seed < 51 + kSeeds; ++seed) {
    MeasuredWalk walk(walk_scenario(length_m), what, seed);
    CouplingConfig config;
    config.type = CouplingType::localizer;
    Composer composer(config, StartPose{}, {what.camera, false});
    std::optional<Vector3d> first;
    double squares = 0, nees = 0;
    int poses = 0, judged = 0;
    walk.run(composer, [&](double t, const odo_pose& pose) {
      if ((pose.header.flags & ODO_POSE_METRIC) == 0) return;
      const bool camera = (pose.header.flags & ODO_POSE_CAMERA) != 0;
      const auto truth = walk.truth(t);
      const Vector3d p_n =
          camera ? truth.p_n_c : Vector3d(truth.p_n_c - truth.q_n_c * (what.q_b_c.conjugate() * walk.p_b_c()));
      Vector3d error = Vector3d(pose.p_n) - p_n;
      if (!first) first = absolute ? Vector3d(Vector3d::Zero()) : error;
      error -= *first;
      squares += error.squaredNorm(), ++poses;
      if (t < 0.5 * walk.duration_s()) return;
      const Matrix2d P =
          Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance).block<2, 2>(3, 3);
      nees += error.head<2>().dot(P.inverse() * error.head<2>()) / 2, ++judged;
    });
    REQUIRE(poses > 10);
    out.rms_m += std::sqrt(squares / poses) / kSeeds;
    out.mean_nees += nees / judged / kSeeds;
    out.worst_nees = std::max(out.worst_nees, nees / judged);
  }
  return out;
}

/// `rms_m`: a tenth above the value at the time of writing.
void check(const WalkMeasurements& what, double length_m, bool absolute, double rms_m) {
  const Outcome out = run(what, length_m, absolute);
  MESSAGE(out.rms_m << " m, NEES " << out.mean_nees << ", worst " << out.worst_nees);
  CHECK(out.rms_m < rms_m);
  CHECK(out.worst_nees < 9);  // three sigmas
}

WalkMeasurements with_inertial_front_end() {
  WalkMeasurements what;
  what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02;
  what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
  return what;
}

}  // namespace

TEST_SUITE_BEGIN("localizer_walk");

TEST_CASE("the track of a visual-inertial front-end is accurate and consistent") {
  check(with_inertial_front_end(), 60, false, 1.35);
}

TEST_CASE("steps bridge five seconds in which a visual-inertial front-end is blind") {
  WalkMeasurements what = with_inertial_front_end();
  what.odometry.blind_from_s = 15, what.odometry.blind_to_s = 20;
  check(what, 60, false, 1.41);
}

TEST_CASE("steps bridge five seconds without frames") {
  WalkMeasurements what = with_inertial_front_end();
  what.odometry.off_from_s = 15, what.odometry.off_to_s = 20;
  check(what, 60, false, 1.46);
}

// With steps alone the scale error is that of the walker's factor, and the position error is that along the path,
// sigma L / sqrt(3) on average.
TEST_CASE("a front-end without metric scale is scaled by the walker's steps, with a consistent covariance") {
  constexpr double kLength_m = 60;
  const WalkMeasurements what;
  const Outcome out = run(what, kLength_m, false);
  MESSAGE(out.rms_m << " m, NEES " << out.mean_nees << ", worst " << out.worst_nees);
  CHECK(out.rms_m < what.step_factor_sigma * kLength_m / std::sqrt(3.0));
  CHECK(out.worst_nees < 9);
}

TEST_CASE("the track of steps alone with late fixes is accurate and consistent") {
  WalkMeasurements what;
  what.camera = false;
  what.fix_every_s = 1, what.fix_sigma_m = 1.5;
  check(what, 100, true, 1.79);
}

TEST_CASE("the track of a visual-inertial front-end with late fixes is accurate and consistent") {
  WalkMeasurements what = with_inertial_front_end();
  what.fix_every_s = 1, what.fix_sigma_m = 1.5;
  check(what, 100, true, 1.74);
}

TEST_SUITE_END();

}  // namespace odograph
