// SPDX-License-Identifier: Apache-2.0
//
// Invariants of the filter and its fusion, by closed forms.
#include <Eigen/Eigenvalues>

#include "tests/support/test_fusion.hpp"
#include "sdk/host/fusion/height.hpp"
#include "sdk/math/atmosphere.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr int64_t kStart_ns = 1'000'000'000, kFrame_ns = 100'000'000;

/// A metric front-end that moves 0.1 m forward per frame.
odo_vo_motion forward(int frame, uint32_t flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_METRIC) {
  const int64_t t_ns = kStart_ns + frame * kFrame_ns;
  auto motion = motion_between(t_ns - kFrame_ns, t_ns, {0, 0, 0.1}, flags);
  motion.scale_sigma = 0.01;
  return motion;
}

const StartPose kGiven{.given = true, .heading_given = true};

/// A fusion of a metric camera's motions.
struct Metric : TestFusion {
  explicit Metric(const CouplingConfig& config = {.type = CouplingType::localizer})
      : TestFusion(config, kGiven, {true, false}) {}
};

void walk(TestFusion& fusion, int from, int to) {
  if (from == 1) fusion.update(FrameTime{kStart_ns});
  for (int k = from; k <= to; ++k) {
    const odo_vo_motion motion = forward(k);
    fusion.update(FrameTime{motion.header.t_ns});
    fusion.update(RelativeMotion{&motion, nullptr});
  }
}

/// A phone with a horizontal rear camera: the body axes of the first frame without an attitude.
odo_imu sample(int64_t t_ns, const Vector3d& gyro_b) {
  return imu_at(t_ns, gyro_b, {0, 9.80665, 0});  // upright: the top of the phone is up
}

void still(TestFusion& fusion, int64_t from_ns, int64_t to_ns) {
  for (int64_t t = from_ns; t <= to_ns; t += 10'000'000) fusion->on_imu(sample(t, Vector3d::Zero()));
}

odo_attitude upright(int64_t t_ns, double heading_rad) {
  auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, t_ns);
  const Eigen::Quaterniond up = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitY(), -Vector3d::UnitZ());
  put_quaternion(Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Vector3d::UnitZ())) * up, attitude.q_n_b);
  attitude.covariance_n[0] = attitude.covariance_n[4] = 1e-4;
  return attitude;
}

odo_step step_of(int64_t from_ns, int64_t to_ns, double length_m) {
  auto step = step_between(from_ns, to_ns, to_ns + 360'000'000, length_m, 0.05 * length_m);
  step.mode = ODO_MODE_WALKING_TEXTING;
  return step;
}

double heading(const TestFusion& fusion) { return fusion.filter().x()[kHeading]; }

Estimate estimate_of(const TestFusion& fusion, Instant t_ns = {}) {
  Estimate estimate;
  REQUIRE(fusion.at(t_ns, estimate) == ODO_OK);
  return estimate;
}

Vector3d position(const TestFusion& fusion) { return Vector3d(estimate_of(fusion).pose.p_n); }

}  // namespace

TEST_SUITE("pose_filter") {
  TEST_CASE("A barometer that starts late leaves the covariance positive semidefinite") {
    PoseFilter filter;
    filter.set(kDown, 3, 0.01);
    filter.set(kClimb, 0, 1);
    filter.add_multiple(kDown, kClimb, 2);  // steps before the first reading: down follows climb
    Height height;
    odo_barometer reading{};
    reading.pressure_pa = 100000;
    REQUIRE(height.use(filter, reading, 3, true).accepted);
    const Eigen::SelfAdjointEigenSolver<PoseFilter::Covariance> solver(filter.P());
    CHECK(solver.eigenvalues().minCoeff() > -1e-12);
    CHECK(filter.P()(kBarometer, kClimb) == -filter.P()(kDown, kClimb));
    CHECK(std::abs(filter.x()[kBarometer] + pressure_height_m(100000) + 3) < 1e-9);
    CHECK(std::abs(filter.P()(kBarometer, kBarometer) - (filter.P()(kDown, kDown) + 0.25)) < 1e-9);
  }

  TEST_CASE("An update equals the Kalman filter's, and a considered state has an effect but does not change") {
    PoseFilter filter;
    filter.set(kNorth, 1, 4);
    filter.set(kBarometer, 2, 5);
    Innovation seen(1);  // measures the sum of both
    seen.residual[0] = 3;
    seen.H(0, kNorth) = seen.H(0, kBarometer) = 1;
    seen.noise(0, 0) = 1;
    const auto result = filter.update(seen, 0, only({kBarometer}));
    CHECK(result.accepted);
    CHECK(std::abs(result.nis - 9.0 / 10) < 1e-12);
    CHECK(std::abs(filter.x()[kNorth] - (1 + 3 * 4.0 / 10)) < 1e-12);
    CHECK(filter.x()[kBarometer] == 2);
    CHECK(std::abs(filter.P()(kNorth, kNorth) - (4 - 16.0 / 10)) < 1e-12);
    CHECK(std::abs(filter.P()(kBarometer, kBarometer) - 5) < 1e-12);
    CHECK(std::abs(filter.P()(kNorth, kBarometer) + 4 * 5 / 10.0) < 1e-12);
  }

  TEST_CASE("A measurement from before the drift is weighted without the drift") {
    PoseFilter late, early;
    for (PoseFilter* filter : {&late, &early}) filter->set(kNorth, 0, 4);
    Innovation seen(1);
    seen.residual[0] = 1;
    seen.H(0, kNorth) = 1;
    seen.noise(0, 0) = 2;
    early.update(seen, 0);
    early.add_variance(kNorth, 1.5);
    late.add_variance(kNorth, 1.5);
    seen.drift_now[kNorth] = 1.5;
    late.update(seen, 0);
    CHECK(std::abs(late.x()[kNorth] - early.x()[kNorth]) < 1e-12);
    CHECK(std::abs(late.P()(kNorth, kNorth) - early.P()(kNorth, kNorth)) < 1e-12);
  }

  TEST_CASE("A metric front-end's track is metric from the given start") {
    Metric fusion;
    walk(fusion, 1, 50);
    const Vector3d moved = position(fusion);
    CHECK(std::abs(moved.norm() - 5) < 1e-9);
    CHECK((fusion->source() == MotionSource::metric_camera));
  }

  TEST_CASE("A fix that is five seconds old moves the newest pose as one in time would have") {
    Metric in_time, late;
    walk(in_time, 1, 100);
    const odo_fix fix = fix_at(kStart_ns + 100 * kFrame_ns, position(in_time) + Vector3d(0.3, 0.2, 0), 0.5);
    CHECK(in_time.update(&fix).accepted);
    walk(in_time, 101, 150);
    walk(late, 1, 150);
    CHECK(late.update(&fix).accepted);
    CHECK((position(in_time) - position(late)).norm() < 2e-3);
  }

  TEST_CASE("A fix older than the stored track is rejected with a reason") {
    Metric fusion;
    walk(fusion, 1, 1200);
    const odo_fix fix = fix_at(kStart_ns + 10 * kFrame_ns, Vector3d(1, 0, 0), 0.5);
    while (fusion.take_notice().key) continue;
    CHECK_FALSE(fusion.update(&fix).accepted);
    CHECK(std::string(fusion.take_notice().key) == "late_fix");
  }

  TEST_CASE("A clock jump of a hundred years costs no time and adds no distance") {
    Metric fusion;
    walk(fusion, 1, 20);
    const Vector3d before = position(fusion);
    constexpr int64_t kYear_ns = 31'557'600'000'000'000;
    auto attitude = attitude_at(kStart_ns + 100 * kYear_ns);
    fusion.update(&attitude);
    const Estimate after = estimate_of(fusion);
    CHECK((after.p_n_b - before).norm() < 1);
    CHECK(fusion.filter().P().allFinite());
  }

  TEST_CASE("A held pose is corrected by a later fix through their correlation") {
    Metric fusion;
    walk(fusion, 1, 100);
    const uint64_t id = fusion->keep_pose(kStart_ns + 50 * kFrame_ns).pose_id;
    KeptPose before, after;
    REQUIRE(fusion->kept_pose(id, before));
    walk(fusion, 101, 150);
    const odo_fix fix = fix_at(kStart_ns + 150 * kFrame_ns, position(fusion) + Vector3d(0.2, 0.1, 0), 0.1);
    const Vector3d now = position(fusion);
    REQUIRE(fusion.update(&fix).accepted);
    REQUIRE(fusion->kept_pose(id, after));
    const double held_m = (after.p_n_b - before.p_n_b).norm(), now_m = (position(fusion) - now).norm();
    CHECK(held_m == Between{0.1 * now_m, now_m});
    CHECK(after.own(3, 3) < before.own(3, 3));
  }

  TEST_CASE("The steps of 700 ms do not overtake a front-end that answers with that delay") {
    Metric late;
    walk(late, 1, 40);
    for (int k = 41; k <= 100; ++k) {
      if (k % 5 == 4 && k > 44) {  // half too long, reported 0.4 s after its end
        const odo_step step = step_of(kStart_ns + (k - 9) * kFrame_ns, kStart_ns + (k - 4) * kFrame_ns, 0.8);
        late.update(&step);
      }
      if (k < 48) continue;
      const odo_vo_motion motion = forward(k - 7);
      late.update(RelativeMotion{&motion, nullptr});
    }
    const Estimate last = estimate_of(late, kStart_ns + 93 * kFrame_ns);
    CHECK(std::abs(last.p_n_b.norm() - 9.3) < 0.01);
  }

  TEST_CASE("Late steps move the track, which is not a correction") {
    Metric fusion;
    const odo_attitude attitude = upright(kStart_ns, 0);
    fusion.update(&attitude);
    walk(fusion, 1, 40);
    odo_pose pose;
    Correction correction;
    fusion.take_correction(correction, pose);
    for (int k = 41; k <= 60; ++k) {
      auto lost = forward(k, 0);
      lost.state = ODO_LOST;
      fusion.update(RelativeMotion{&lost, nullptr});
      const Vector3d before = position(fusion);
      if (k % 5 != 0 || k < 50) continue;
      const odo_step step = step_of(kStart_ns + (k - 10) * kFrame_ns, kStart_ns + (k - 5) * kFrame_ns, 0.6);
      fusion.update(&step);
      CHECK(std::abs((position(fusion) - before).norm() - 0.6) < 0.05);
    }
    CHECK_FALSE(fusion.take_correction(correction, pose));
    CHECK((fusion->source() == MotionSource::steps));
  }

  TEST_CASE("A rotation that contradicts the gyroscope is rejected and moves nothing") {
    Metric fusion;
    still(fusion, kStart_ns - kFrame_ns, kStart_ns + 21 * kFrame_ns);
    walk(fusion, 1, 20);
    const Estimate before = estimate_of(fusion);
    odo_vo_motion motion = forward(21);
    put_quaternion(exp_rotation(Vector3d(0, 0.1, 0)), motion.q_c0_c1);
    fusion.update(RelativeMotion{&motion, nullptr});
    const Estimate after = estimate_of(fusion);
    CHECK(after.q_n_b.angularDistance(before.q_n_b) < 1e-3);
    CHECK((after.p_n_b - before.p_n_b).norm() < 1e-3);
  }

  TEST_CASE("Beyond the gyroscope's end the front-end's rotation is used, with the uncertainty of an unchecked one") {
    Metric fusion;
    still(fusion, kStart_ns - kFrame_ns, kStart_ns + 20 * kFrame_ns);
    walk(fusion, 1, 20);
    const Estimate before = estimate_of(fusion);
    const double sigma_rad = fusion.filter().sigma(kHeading);
    for (int k = 22; k <= 30; ++k) {  // 21 ends 0.1 s after the last sample
      odo_vo_motion motion = forward(k);
      put_quaternion(exp_rotation(Vector3d(0, 0.1, 0)), motion.q_c0_c1);
      fusion.update(RelativeMotion{&motion, nullptr});
    }
    const Estimate after = estimate_of(fusion);
    CHECK(std::abs(after.q_n_b.angularDistance(before.q_n_b) - 0.9) < 0.02);
    CHECK(fusion.filter().sigma(kHeading) > sigma_rad + 0.3);
  }

  TEST_CASE("Over a gap the attitude source's frame may have rotated, and its offset is estimated again") {
    Metric fusion;
    still(fusion, kStart_ns - kFrame_ns, kStart_ns + 81 * kFrame_ns);
    for (int k = 0; k <= 20; ++k) {
      const odo_attitude attitude = upright(kStart_ns + k * kFrame_ns, 0);
      fusion.update(&attitude);
      if (k > 0) walk(fusion, k, k);
    }
    walk(fusion, 21, 50);
    for (int k = 51; k <= 80; ++k) {  // 1 rad off since
      const odo_attitude attitude = upright(kStart_ns + k * kFrame_ns, 1);
      fusion.update(&attitude);
      walk(fusion, k, k);
    }
    CHECK(std::abs(fusion.filter().x()[kAttitudeHeading] + 1) < 0.05);
    CHECK(std::abs(heading(fusion)) < 1e-6);
  }

  TEST_CASE("A fix's orientation corrects the inclination of a composed gyroscope") {
    Metric fusion({.orientation = Orientation::gyroscope, .type = CouplingType::paper});
    odo_attitude attitude = upright(kStart_ns - kFrame_ns, 0);
    attitude.covariance_n[0] = attitude.covariance_n[4] = 0.01;
    fusion.update(&attitude);
    still(fusion, kStart_ns - kFrame_ns, kStart_ns + 30 * kFrame_ns);
    walk(fusion, 1, 20);
    const Estimate before = estimate_of(fusion);
    auto fix = make_message<odo_fix>(ODO_TYPE_FIX, kStart_ns + 20 * kFrame_ns);
    fix.header.flags = ODO_FIX_ORIENTATION | ODO_FIX_ORIENTATION_COVARIANCE;
    put_quaternion(exp_rotation(Vector3d(0.05, 0, 0)) * before.q_n_b, fix.q_n_b);
    for (const int i : {0, 4, 8}) fix.orientation_cov_n[i] = 1e-6;
    CHECK(fusion.update(&fix).accepted);
    walk(fusion, 21, 21);
    const Estimate after = estimate_of(fusion);
    CHECK(after.q_n_b.angularDistance(quaternion(fix.q_n_b)) < 0.015);
  }

  TEST_CASE("A fix whose position is rejected has no effect on the heading") {
    Metric fusion;
    walk(fusion, 1, 50);
    const Estimate before = estimate_of(fusion);
    odo_fix fix = fix_at(kStart_ns + 50 * kFrame_ns, position(fusion) + Vector3d(50, 0, 0), 0.5);
    fix.header.flags |= ODO_FIX_ORIENTATION | ODO_FIX_ORIENTATION_COVARIANCE;
    put_quaternion(exp_rotation(Vector3d(0, 0, 0.06)) * before.q_n_b, fix.q_n_b);
    for (const int i : {0, 4, 8}) fix.orientation_cov_n[i] = 0.01;
    const double was = heading(fusion);
    CHECK_FALSE(fusion.update(&fix).accepted);
    CHECK(heading(fusion) == was);
  }

  TEST_CASE("Unobserved motion of the leading camera is bounded by the carrier's speed") {
    Metric fusion({.fastest_mps = 2, .type = CouplingType::localizer});
    walk(fusion, 1, 20);
    const odo_vo_motion motion = forward(51);  // 3 s later, of a frame 0.1 s before
    fusion.update(RelativeMotion{&motion, nullptr});
    CHECK(std::abs(fusion.filter().sigma(kNorth) - 2 * 3) < 0.1);
  }

  TEST_CASE("A correction of two centimetres is no event, and one of thirty is") {
    Metric fusion;
    walk(fusion, 1, 100);
    odo_pose pose;
    Correction correction;
    for (const double off_m : {0.02, 0.3}) {
      const Vector3d was = position(fusion);
      const odo_fix fix = fix_at(kStart_ns + 100 * kFrame_ns, was + Vector3d(off_m, 0, 0), 0.1);
      REQUIRE(fusion.update(&fix).accepted);
      CHECK(fusion.take_correction(correction, pose) == (off_m > 0.1));
      CHECK((position(fusion) - was).norm() > 0.3 * off_m);
    }
    CHECK(correction.reason == ODO_CORRECTION_FIX);
  }

  TEST_CASE("A walker's estimated factor decays over 200 steps, within the spread among walkers") {
    PoseFilter filter;
    StepModel steps;
    steps.reset(filter);
    filter.set(kLogFactor, 0.3, 1e-6);
    const odo_step step = step_of(kStart_ns, kStart_ns + 5 * kFrame_ns, 0.7);
    steps.propagate(filter, step, true);
    filter.set(kLogFactor, 0.3, 1e-6);
    for (int i = 0; i < 200; ++i) steps.propagate(filter, step, true);
    CHECK(std::abs(filter.x()[kLogFactor] - 0.3 / std::exp(1)) < 1e-3);
    for (int i = 0; i < 5000; ++i) steps.propagate(filter, step, true);
    CHECK(std::abs(filter.sigma(kLogFactor) - 0.10) < 1e-3);
  }

  TEST_CASE("A scale that a front-end reports repeatedly counts once") {
    Metric fusion;
    walk(fusion, 1, 100);
    CHECK(fusion.filter().sigma(kLogScale) > 0.0099);
  }

  TEST_CASE("The correction by a better scale is not distance") {
    TestFusion fusion({.type = CouplingType::localizer}, kGiven, {true, true});
    fusion.update(FrameTime{kStart_ns});
    for (int k = 1; k <= 60; ++k) {
      const odo_vo_motion motion = forward(k, ODO_VO_ROTATION | ODO_VO_TRANSLATION);
      auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, motion.header.t_ns);
      scale.scale = k < 40 ? 1 : 1.3, scale.sigma = k < 40 ? 0.3 : 0.01;
      fusion.update(FrameTime{motion.header.t_ns});
      fusion.update(RelativeMotion{&motion, &scale});
    }
    CHECK(position(fusion).norm() > 7);  // everything is 1.3 times as long
    CHECK(std::abs(fusion->distance_m() - (39 * 0.1 + 21 * 0.13)) < 0.15);
  }

  TEST_CASE("By the papers' rules each motion is multiplied by its own scale, horizontally") {
    TestFusion fusion({.type = CouplingType::paper}, kGiven, {true, true});
    fusion.update(FrameTime{kStart_ns});
    double expected_m = 0;
    for (int k = 1; k <= 30; ++k) {
      const odo_vo_motion motion = forward(k, ODO_VO_ROTATION | ODO_VO_TRANSLATION);
      auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, motion.header.t_ns);
      scale.header.flags = ODO_SCALE_HORIZONTAL;
      scale.scale = 1 + 0.1 * (k % 3);
      scale.sigma = 0.05;
      expected_m += 0.1 * scale.scale;
      fusion.update(FrameTime{motion.header.t_ns});
      fusion.update(RelativeMotion{&motion, &scale});
    }
    CHECK(std::abs(position(fusion).norm() - expected_m) < 1e-9);
    CHECK(std::abs(fusion->distance_m() - expected_m) < 1e-9);
  }
}

}  // namespace odograph
