// SPDX-License-Identifier: Apache-2.0
//
// Predicted poses in closed form and at their limits: integration, prediction, blending.
#include "sdk/host/fusion/inertial_track.hpp"
#include "sdk/host/core/pose_predictor.hpp"
#include "sdk/host/core/smooth_pose.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("motion_ahead");

namespace {

constexpr int64_t kMs = 1'000'000;

double away(const Vector3d& a, const Vector3d& b) { return (a - b).norm(); }
double away(const Quaterniond& a, const Quaterniond& b) { return log_rotation(a.conjugate() * b).norm(); }

const Vector3d kRate(0.3, -0.2, 0.5), kForce(1, -2, 3), kZero = Vector3d::Zero();

}  // namespace

TEST_CASE("a linearly growing force is integrated exactly, between, at and beyond the samples") {
  InertialTrack track;
  track.set_biases(kRate, kForce);  // subtracted: only the force remains
  const auto force = [](double t) { return Vector3d(2 * t, 1 - t, 0.5); };
  for (int i = 0; i <= 10; ++i) track.add(imu_at(i * 10 * kMs, kRate, kForce + force(0.01 * i)));
  const auto first = *track.at(0, 0.1);
  for (const double t : {0.0, 0.004, 0.01, 0.0437, 0.1}) {
    CAPTURE(t);
    const auto p = required(track.at(std::llround(t * 1e9), 0.1));
    CHECK(p->t_ns == std::llround(t * 1e9));
    CHECK(away(p->v_e - first.v_e, Vector3d(t * t, t - t * t / 2, 0.5 * t)) < 1e-12);
    CHECK(away(p->p_e - first.p_e, Vector3d(t * t * t / 3, t * t / 2 - t * t * t / 6, 0.25 * t * t)) < 1e-12);
    CHECK(away(p->force_b, force(t)) < 1e-12);
    CHECK(p->rate_b.norm() < 1e-12);
  }
  const auto last = *track.at(100 * kMs, 0.1), beyond = *track.at(150 * kMs, 0.1), far = *track.at(900 * kMs, 0.1);
  CHECK(away(beyond.v_e, last.v_e + 0.05 * force(0.1)) < 1e-12);
  CHECK(away(beyond.p_e, last.p_e + 0.05 * last.v_e + 0.5 * 0.05 * 0.05 * force(0.1)) < 1e-12);
  CHECK(far.t_ns == 200 * kMs);  // not beyond the request
  CHECK_FALSE(track.at(-1, 0.1));
  track.clear();
  CHECK_FALSE(track.at(0, 0.1));
  CHECK(track.newest_ns() == INT64_MIN);
}

TEST_CASE("a rotation of constant rate is integrated exactly, and a changing rate by its mean") {
  InertialTrack track;
  for (int i = 0; i <= 10; ++i) track.add(imu_at(i * 10 * kMs, kRate, kZero));
  const auto first = *track.at(0, 0.1);
  for (const double t : {0.003, 0.05, 0.1, 0.17})
    CHECK(away(first.q_e_b * exp_rotation(t * kRate), track.at(std::llround(t * 1e9), 0.1)->q_e_b) < 1e-12);
  track.add(imu_at(120 * kMs, 3 * kRate, kZero));
  CHECK(away(first.q_e_b * exp_rotation((0.1 + 0.02 * 2) * kRate), track.at(120 * kMs, 0.1)->q_e_b) < 1e-12);
}

TEST_CASE("gaps of either sensor are bridged up to 0.1 s, and samples that are not newer are ignored") {
  for (const int64_t gap : {100 * kMs, 100 * kMs + 1}) {
    InertialTrack track;
    track.add(imu_at(0, kRate, kForce));
    track.add(imu_at(gap, kRate, kForce));
    CHECK(track.at(1, 0.1).has_value() == (gap == 100 * kMs));
    CHECK(track.at(gap, 0.1).has_value());
    track.add(imu_at(gap, -5 * kRate, 5 * kForce)), track.add(imu_at(gap - 1, kRate, kForce));
    CHECK(away(track.at(gap, 0.1)->rate_b, kRate) < 1e-12);
    CHECK(away(track.at(gap, 0.1)->force_b, kForce) < 1e-12);
    InertialTrack silent;
    silent.add(imu_at(0, kRate, kForce));
    CHECK(silent.has_force());
    silent.add(imu_at(gap, kRate, kZero, ODO_IMU_GYRO));
    CHECK(silent.has_force() == (gap == 100 * kMs));
  }
  CHECK_FALSE(InertialTrack().has_force());
}

TEST_CASE("separate and late accelerometer samples are interpolated between their neighbours") {
  InertialTrack apart, whole;
  const auto force = [](int64_t t) { return Vector3d(1e-9 * static_cast<double>(t) * Vector3d(30, 10, -20)); };
  for (int64_t t = 0; t <= 60 * kMs; t += 5 * kMs) whole.add(imu_at(t, kRate, force(t)));
  apart.add(imu_at(0, kZero, force(0), ODO_IMU_ACCEL));
  for (int64_t t = 0; t <= 60 * kMs; t += 5 * kMs) {
    apart.add(imu_at(t, kRate, kZero, ODO_IMU_GYRO));
    if (t % (20 * kMs) == 0) apart.add(imu_at(t, kZero, force(t), ODO_IMU_ACCEL));
  }
  for (const int64_t t : {0, 13, 20, 35, 59, 60}) {
    const auto a = *apart.at(t * kMs, 0.1), b = *whole.at(t * kMs, 0.1);
    CHECK(away(a.v_e, b.v_e) < 1e-12);
    CHECK(away(a.p_e, b.p_e) < 1e-12);
  }
}

TEST_CASE("a jump decays at a limited speed first and exponentially then, and no second jump appears") {
  const SmoothPose::Pose after{exp_rotation({0.2, 0, 0.3}), {1, 2, 3}};
  const Vector3d jump(0.12, -0.16, 0), rotated(0, 0.06, 0.08);  // 0.2 m and 0.1 rad
  SmoothPose smooth;
  CHECK(away(smooth.at(5, after).p_n, after.p_n) == 0);
  smooth.jumped(1000 * kMs, {exp_rotation(rotated) * after.q_n, after.p_n + jump}, after);
  const auto shift = [&](double t) { return Vector3d(smooth.at(std::llround((1 + t) * 1e9), after).p_n - after.p_n); };
  const auto rotation = [&](double t) {
    return log_rotation(smooth.at(std::llround((1 + t) * 1e9), after).q_n * after.q_n.conjugate());
  };
  // 0.5 m/s down to 0.075 m after 0.25 s, then a time constant of 0.15 s; 0.17 rad/s down to 0.0255 rad.
  for (const auto& [t, left] :
       {std::pair{-1.0, 0.2}, {0.0, 0.2}, {0.1, 0.15}, {0.25, 0.075}, {0.4, 0.075 * std::exp(-1)}})
    CHECK(away(shift(t), jump * (left / 0.2)) < 1e-9);
  const double knee_s = (0.1 - 0.0255) / 0.17;
  for (const auto& [t, left] :
       {std::pair{0.0, 0.1}, {0.2, 0.066}, {knee_s, 0.0255}, {knee_s + 0.3, 0.0255 * std::exp(-2)}})
    CHECK(away(rotation(t), rotated * (left / 0.1)) < 1e-7);
  const SmoothPose::Pose seen = smooth.at(1100 * kMs, after), there{exp_rotation({0, 0, 3}), {-5, 0, 0}};
  smooth.jumped(1100 * kMs, after, there);
  CHECK(away(smooth.at(1100 * kMs, there).p_n, seen.p_n) < 1e-12);
  CHECK(away(smooth.at(1100 * kMs, there).q_n, seen.q_n) < 1e-7);
  smooth.reset();
  CHECK(away(smooth.at(1100 * kMs, there).p_n, there.p_n) == 0);
}

namespace {

/// A horizontal camera at rest above the ground, at 10 Hz with an IMU at 200 Hz up to one second.
struct Still {
  PosePredictor predictor;
  const Quaterniond q_b_c = exp_rotation({3, 0.2, 0});
  const Vector3d p_b_c{0.03, 0.05, -0.02}, velocity{0.5, 0, 0};

  explicit Still(bool moves, bool camera = true) {
    for (int i = 0; i <= 200; ++i) predictor.add_imu(imu_at(i * 5 * kMs, {0, 0, moves ? 0.4 : 0}, {0, 0, -9.80665}));
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, 1000 * kMs);
    pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC | (camera ? ODO_POSE_CAMERA : 0);
    put_quaternion(q_b_c, pose.q_n);
    Vector3d::Map(pose.p_n) = p_b_c;
    for (const int i : {21, 28, 35}) pose.covariance[i] = 0.01;
    PosePredictor::Base base{pose, Quaterniond::Identity(), kZero, {}, {}};
    if (moves) base.v_n_b = velocity;
    predictor.set_state(ODO_TRACKING, ODO_REASON_NONE);
    predictor.add_pose(1000 * kMs, base);
  }
  odo_pose at(int64_t t_ns, int32_t status = ODO_OK) const {
    odo_pose out{};
    CHECK(predictor.at(t_ns, false, out) == status);
    return out;
  }
};

}  // namespace

TEST_CASE("a pose is predicted up to half a second ahead and not a nanosecond more, and so is the position") {
  const Still still(false);
  CHECK((still.at(1000 * kMs).header.flags & ODO_POSE_EXTRAPOLATED) == 0);
  CHECK((still.at(1000 * kMs + 1).header.flags & ODO_POSE_EXTRAPOLATED) != 0);
  CHECK((still.at(1500 * kMs).header.flags & ODO_POSE_POSITION) != 0);
  still.at(1500 * kMs + 1, ODO_E_NOT_FOUND);
  CHECK(still.at(INT64_MIN).header.t_ns == 1000 * kMs);
  Still longer(false);
  for (int i = 1; i <= 100; ++i) longer.predictor.add_imu(imu_at((1000 + 5 * i) * kMs, kZero, {0, 0, -9.80665}));
  CHECK((longer.at(1500 * kMs).header.flags & ODO_POSE_POSITION) != 0);
  const odo_pose late = longer.at(1500 * kMs + 1);
  CHECK((late.header.flags & (ODO_POSE_POSITION | ODO_POSE_METRIC | ODO_POSE_VELOCITY)) == 0);
  CHECK((late.state == ODO_LOST && late.reason == ODO_REASON_SENSOR_SILENT));
  longer.predictor.set_state(ODO_DEGRADED, ODO_REASON_TOO_DARK);
  CHECK(longer.at(1600 * kMs).state == ODO_DEGRADED);
  CHECK(longer.at(1600 * kMs).reason == ODO_REASON_TOO_DARK);
  longer.predictor.set_state(ODO_LOST, ODO_REASON_TOO_DARK);
  CHECK((longer.at(1100 * kMs).header.flags & ODO_POSE_POSITION) == 0);
}

TEST_CASE("the position sigma grows by 0.1 m/s with a velocity and by 1.5 m/s without, in its own axes only") {
  for (const bool moves : {false, true})
    for (const int64_t ahead : {0, 20, 80}) {
      const Still still(moves);
      const odo_pose pose = still.at((1000 + ahead) * kMs);
      const double sigma = (moves ? 0.1 : 1.5) * 1e-3 * static_cast<double>(ahead);
      CHECK(((pose.header.flags & ODO_POSE_VELOCITY) != 0) == moves);
      for (int i = 0; i < 36; ++i) {
        const bool own = i == 21 || i == 28 || i == 35;
        CHECK(pose.covariance[i] == doctest::Approx(own ? 0.01 + sigma * sigma : 0).epsilon(1e-9));
      }
    }
}

TEST_CASE("a camera beside the body's origin moves with the rotation, with its own velocity and rate") {
  const Still still(true);
  const odo_pose pose = still.at(1080 * kMs);
  const Quaterniond q_n_b = exp_rotation({0, 0, 0.4 * 0.08});
  const Vector3d rate(0, 0, 0.4);
  CHECK(away(quaternion(pose.q_n), q_n_b * still.q_b_c) < 1e-9);
  CHECK(away(Vector3d(pose.p_n), 0.08 * still.velocity + q_n_b * still.p_b_c) < 1e-6);
  CHECK(away(Vector3d(pose.velocity_n), still.velocity + q_n_b * rate.cross(still.p_b_c)) < 1e-6);
  CHECK(away(Vector3d(pose.angular_velocity), still.q_b_c.conjugate() * rate) < 1e-9);
  CHECK((pose.header.flags & ODO_POSE_ANGULAR_VELOCITY) != 0);
}

TEST_CASE("a correction moves the pose at once but not the smooth one, and clearing discards everything") {
  Still still(false);
  const Quaterniond q = exp_rotation({0, 0, 0.3});
  const Vector3d p(1, -2, 0.5);
  odo_pose before{}, smooth{};
  REQUIRE(still.predictor.at(1050 * kMs, true, before) == ODO_OK);
  still.predictor.correct({q, p});
  REQUIRE(still.predictor.at(1050 * kMs, true, smooth) == ODO_OK);
  CHECK(away(Vector3d(smooth.p_n), Vector3d(before.p_n)) < 1e-9);
  CHECK(away(quaternion(smooth.q_n), quaternion(before.q_n)) < 1e-7);
  const odo_pose corrected = still.at(1050 * kMs);
  CHECK(away(Vector3d(corrected.p_n), q * Vector3d(before.p_n) + p) < 1e-9);
  CHECK(away(quaternion(corrected.q_n), q * quaternion(before.q_n)) < 1e-7);
  CHECK(still.predictor.published_ns() == 1000 * kMs);
  still.predictor.clear();
  CHECK(still.predictor.published_ns() == INT64_MIN);
  still.at(1050 * kMs, ODO_NOT_READY);
}

TEST_CASE("a walker who makes no step keeps the place, within the step in progress") {
  PosePredictor predictor;
  PosePredictor::Base base;
  base.pose = make_message<odo_pose>(ODO_TYPE_POSE, 0);
  base.pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_POSITION | ODO_POSE_METRIC | ODO_POSE_COVARIANCE;
  base.pose.q_n[0] = 1, base.pose.state = ODO_TRACKING;
  predictor.add_pose(0, base);
  predictor.add_attitude(attitude_at(12'000 * kMs));
  odo_pose pose{};
  REQUIRE(predictor.at(12'000 * kMs, false, pose) == ODO_OK);
  for (const int i : {21, 28, 35}) CHECK(std::sqrt(pose.covariance[i]) == Between{1.0, 2.0});
}

TEST_CASE("a walker's attitude alone gives the orientation at its own newer time") {
  PosePredictor predictor;
  const auto add = [&](int64_t t_ns, const Quaterniond& q) { predictor.add_attitude(attitude_at(t_ns, q)); };
  odo_pose pose{};
  CHECK(predictor.at(0, false, pose) == ODO_NOT_READY);
  const Quaterniond q = exp_rotation(kRate);
  add(10 * kMs, q), add(10 * kMs, Quaterniond::Identity()), add(5 * kMs, Quaterniond::Identity());
  REQUIRE(predictor.at(INT64_MIN, false, pose) == ODO_OK);
  CHECK(pose.header.t_ns == 10 * kMs);
  CHECK(pose.header.flags == (ODO_POSE_ORIENTATION | ODO_POSE_EXTRAPOLATED));
  CHECK(pose.state == ODO_LOST);
  CHECK(away(quaternion(pose.q_n), q) < 1e-9);
}
