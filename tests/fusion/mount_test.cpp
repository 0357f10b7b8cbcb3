// SPDX-License-Identifier: Apache-2.0
//
// The camera's mount. Oracle: the body's track is independent of it.
#include "sdk/host/base/pose_frame.hpp"
#include "tests/support/measured_walk.hpp"
#include "tests/fusion/paper_track.hpp"
#include "tests/support/support.hpp"
#include "tests/support/messages.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("mount");

namespace {

constexpr int64_t kSecond = 1'000'000'000;
const Quaterniond kPhone(0, 1, 0, 0);                                      // its own inverse
const Quaterniond kAskew = Quaterniond(0.5, 0.7, -0.3, 0.4).normalized();  // none of its components is trivial

Quaterniond q_of(const odo_pose& pose) { return {pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]}; }

struct BodyTrack {
  std::vector<Quaterniond> q_n_b;
  std::vector<Vector3d> p_n_c;
};

BodyTrack track_of(WalkMeasurements what, const Quaterniond& mount) {
  what.q_b_c = mount;
  MeasuredWalk walk(walk_scenario(25), what, 3);
  TestFusion fusion({.type = CouplingType::localizer}, {}, {.vo = true, .scale = false});
  BodyTrack track;
  walk.run(fusion, [&](double, const odo_pose& pose) {
    if (!(pose.header.flags & ODO_POSE_CAMERA)) return;
    track.q_n_b.push_back(q_of(pose) * mount.conjugate());
    track.p_n_c.push_back(Vector3d(pose.p_n));
  });
  return track;
}

}  // namespace

TEST_CASE("the inertial estimator's track of the body is independent of the camera's mount") {
  for (const double scale_sigma : {0.0, 0.02}) {  // up to scale; metric and inertial
    CAPTURE(scale_sigma);
    WalkMeasurements what;
    what.odometry.scale_sigma = scale_sigma;
    if (scale_sigma > 0) what.odometry.inverse_scale = 1;
    const BodyTrack phone = track_of(what, kPhone), askew = track_of(what, kAskew);
    REQUIRE(phone.p_n_c.size() == askew.p_n_c.size());
    REQUIRE(phone.p_n_c.size() > 100);
    double apart_m = 0, apart_rad = 0;
    for (size_t i = 0; i < phone.p_n_c.size(); ++i) {
      apart_m = std::max(apart_m, (phone.p_n_c[i] - askew.p_n_c[i]).norm());
      apart_rad = std::max(apart_rad, phone.q_n_b[i].angularDistance(askew.q_n_b[i]));
    }
    MESSAGE(apart_m << " m, " << apart_rad << " rad apart");
    CHECK(apart_m < 1e-6);
    CHECK(apart_rad < 1e-6);
  }
}

TEST_CASE("the camera's covariance is the body's, propagated over the lever arm") {
  WalkMeasurements what;
  MeasuredWalk walk(walk_scenario(15), what, 4);
  TestFusion fusion({.type = CouplingType::localizer}, {}, {.vo = true, .scale = false});
  int compared = 0;
  double worst = 0, told = 0;
  walk.run(fusion, [&](double, const odo_pose&) {
    Estimate newest;
    KeptPose body;
    if (fusion.at({}, newest) != ODO_OK || !fusion->pose_now(body)) return;
    if (newest.p_n_b != body.p_n_b || !(newest.pose.header.flags & ODO_POSE_POSITION)) return;  // of another time
    const Vector3d lever_n = body.q_n_b * walk.p_b_c();
    // A small rotation moves the end of the lever.
    Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Identity();
    J.bottomLeftCorner<3, 3>() << 0, lever_n.z(), -lever_n.y(), -lever_n.z(), 0, lever_n.x(), lever_n.y(), -lever_n.x(),
        0;
    const Eigen::Matrix<double, 6, 6> expected = J * body.own * J.transpose();
    const auto actual = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(newest.pose.covariance);
    worst = std::max(worst, (actual - expected).norm() / expected.norm());
    told = std::max(told, (body.own - expected).norm() / expected.norm());
    ++compared;
  });
  CHECK(compared > 50);
  CHECK(worst < 1e-12);
  CHECK(told > 1e-5);  // the lever has an effect
}

TEST_CASE("the camera's pose has the camera's velocity, and the estimate the body's") {
  WalkMeasurements what;
  what.odometry.scale_sigma = 0.02, what.odometry.inverse_scale = 1;
  MeasuredWalk walk(walk_scenario(15), what, 4);
  TestFusion fusion({.type = CouplingType::localizer}, {}, {.vo = true, .scale = false});
  int compared = 0;
  double worst = 0, largest = 0;
  walk.run(fusion, [&](double t, const odo_pose& pose) {
    Estimate then;
    if (!(pose.header.flags & ODO_POSE_VELOCITY) || fusion.at(pose.header.t_ns, then) != ODO_OK) return;
    constexpr double h = 1e-3;
    const auto q_n_b = [&](double at) { return Quaterniond(walk.truth(at).q_n_c * kPhone); };
    const Vector3d rate_b = log_rotation(q_n_b(t - h).conjugate() * q_n_b(t + h)) / (2 * h);
    const Vector3d between_b = then.q_n_b.conjugate() * Vector3d(Vector3d(pose.velocity_n) - then.v_n_b);
    worst = std::max(worst, (between_b - rate_b.cross(walk.p_b_c())).norm());
    largest = std::max(largest, between_b.norm());
    ++compared;
  });
  CHECK(compared > 50);
  CHECK(worst < 0.01);  // noise of the gyroscope, times 7 cm
  CHECK(largest > 0.02);
}

TEST_CASE("while the camera is blind the attitude rotates it through its mount") {
  PaperTrack coupling({}, {}, {true, false});
  auto lens = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  lens.header.flags = ODO_CALIBRATION_EXTRINSICS;
  lens.q_b_c[0] = kAskew.w(), lens.q_b_c[1] = kAskew.x(), lens.q_b_c[2] = kAskew.y(), lens.q_b_c[3] = kAskew.z();
  coupling.on_calibration(lens);
  const Quaterniond q0 = Quaterniond(0.7, -0.2, 0.5, 0.4).normalized();
  const Quaterniond q1(Eigen::AngleAxisd(0.8, Vector3d(0.3, -0.2, 0.9).normalized()) * q0);
  coupling.on_attitude(attitude_at(0, q0));
  CHECK(q_of(coupling.on_first_frame(0)).angularDistance(q0 * kAskew) < 1e-7);
  coupling.on_attitude(attitude_at(kSecond, q1));
  auto blind = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, kSecond);
  blind.t_from_ns = 0, blind.q_c0_c1[0] = 1, blind.state = ODO_LOST;
  CHECK(q_of(coupling.on_vo_motion(blind, nullptr)).angularDistance(q1 * kAskew) < 1e-7);
}

TEST_CASE("heading uncertainty gives position uncertainty across the path, in proportion to the distance") {
  PaperTrack coupling({.orientation = Orientation::attitude}, {}, {true, true});
  const auto add_attitude = [&](int64_t t_ns) {
    odo_attitude a = attitude_at(t_ns, Quaterniond::Identity());
    a.header.flags |= ODO_ATTITUDE_MAGNETIC_NORTH;
    a.covariance_n[8] = 0.01;  // of the heading, rad^2
    coupling.on_attitude(a);
  };
  add_attitude(0);
  coupling.on_first_frame(0);
  auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
  scale.header.flags = ODO_SCALE_HORIZONTAL;
  scale.scale = 1;
  odo_pose pose{};
  for (int64_t k = 1; k <= 2; ++k) {
    add_attitude(k * kSecond);
    auto motion = motion_between((k - 1) * kSecond, k * kSecond, {10, 0, 0});
    pose = coupling.on_vo_motion(motion, &scale);
  }
  const Eigen::Vector2d moved(pose.p_n[0], pose.p_n[1]), along = moved.normalized(), across(-along.y(), along.x());
  Eigen::Matrix2d P;
  P << pose.covariance[3 * 6 + 3], pose.covariance[3 * 6 + 4], pose.covariance[4 * 6 + 3], pose.covariance[4 * 6 + 4];
  REQUIRE(moved.norm() > 5);
  CHECK(across.dot(P * across) == doctest::Approx(0.01 * moved.squaredNorm()).epsilon(0.01));
  CHECK(along.dot(P * along) < 1e-5 * moved.squaredNorm());
}

TEST_CASE("the pose of another rigid part moves and rotates as that part does") {
  const Quaterniond q0(Eigen::AngleAxisd(2.1, Vector3d(0.4, -0.5, 0.7).normalized()));
  const Vector3d p0(5, -3, 1), v_n(1.1, -0.4, 0.2), rate_b(0.6, -1.1, 0.8), lever_b(0.3, -0.2, 0.5);
  const auto at = [&](double t_s) {
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, 0);
    pose.header.flags = ODO_POSE_VELOCITY | ODO_POSE_ANGULAR_VELOCITY;
    const Quaterniond q = q0 * exp_rotation(t_s * rate_b);
    pose.q_n[0] = q.w(), pose.q_n[1] = q.x(), pose.q_n[2] = q.y(), pose.q_n[3] = q.z();
    Vector3d::Map(pose.p_n) = p0 + t_s * v_n;
    Vector3d::Map(pose.velocity_n) = v_n, Vector3d::Map(pose.angular_velocity) = rate_b;
    move_pose(kAskew, lever_b, pose);
    return pose;
  };
  constexpr double h = 1e-5;
  const odo_pose before = at(-h), now = at(0), after = at(h);
  CHECK((Vector3d(now.p_n) - (p0 + q0 * lever_b)).norm() < 1e-12);
  CHECK((Vector3d(now.velocity_n) - (Vector3d(after.p_n) - Vector3d(before.p_n)) / (2 * h)).norm() < 1e-6);
  const Vector3d rate = log_rotation(q_of(before).conjugate() * q_of(after)) / (2 * h);
  CHECK((Vector3d(now.angular_velocity) - rate).norm() < 1e-6);
}

TEST_CASE("a steady scale ends the uncertainty of the preceding segment only") {
  for (const bool steady : {true, false}) {
    CAPTURE(steady);
    PaperTrack coupling({.fastest_mps = 2}, {.position_m = {0, 0, 0}, .heading_rad = 0, .given = true},
                        {.vo = true, .scale = true});
    const auto sigma_m = [&](int64_t k, bool sees, const odo_scale* scale) {
      auto motion = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, k * kSecond);
      motion.t_from_ns = (k - 1) * kSecond;
      motion.q_c0_c1[0] = 1, motion.p_c0_c1[2] = 0.5;
      if (sees) motion.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION;
      motion.state = sees ? ODO_TRACKING : ODO_LOST;
      return std::sqrt(coupling.on_vo_motion(motion, scale).covariance[3 * 6 + 3]);
    };
    coupling.on_first_frame(0);
    CHECK(sigma_m(1, false, nullptr) == doctest::Approx(2));
    for (int64_t k = 2; k < 10; ++k) sigma_m(k, true, nullptr);
    CHECK(sigma_m(10, true, nullptr) == doctest::Approx(20));
    auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
    scale.header.flags = ODO_SCALE_HORIZONTAL | (steady ? ODO_SCALE_STEADY : 0);
    scale.scale = 2, scale.sigma = 1e-6;
    CHECK(sigma_m(11, true, &scale) == doctest::Approx(steady ? 2 : 20).epsilon(0.01));
  }
}
