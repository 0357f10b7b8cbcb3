// SPDX-License-Identifier: Apache-2.0
//
// The papers' estimator: fixed defects.
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/fusion/paper_track.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("estimator_paper");

namespace {

constexpr int64_t kSecond = 1'000'000'000;

Quaterniond orientation(const odo_pose& pose) {
  return Quaterniond(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
}

/// A body whose y axis is the camera's viewing direction, so that a horizontal camera's heading is the body's.
odo_calibration forward_mount() {
  auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  calibration.header.flags = ODO_CALIBRATION_EXTRINSICS;
  calibration.q_b_c[0] = std::sqrt(0.5), calibration.q_b_c[1] = -std::sqrt(0.5);
  return calibration;
}

double body_yaw(const odo_pose& pose) {
  const Vector3d y = orientation(pose) * Vector3d::UnitZ();
  return std::atan2(y.y(), y.x());
}

}  // namespace

TEST_CASE("uncertainty about the camera's down axis is heading uncertainty, which a yaw fix reduces") {
  for (const int axis : {0, 1, 2}) {
    PaperTrack coupling({}, {}, {true, true});
    coupling.on_calibration(forward_mount());
    coupling.on_first_frame(0);  // horizontal, facing north: y is down
    // The 0.2 rad of an uninformed start would hide the effect.
    coupling.on_fix(yaw_fix_at(0, 0, 0.001));
    auto m = motion_between(0, kSecond, {0, 0, 0});
    m.header.flags |= ODO_VO_COVARIANCE;
    m.covariance[7 * axis] = 0.2 * 0.2;
    const odo_pose before = coupling.on_vo_motion(m, nullptr);
    const double yaw = body_yaw(before);
    CHECK(coupling.on_fix(yaw_fix_at(kSecond, yaw + 0.15, 0.02)).accepted == (axis == 1));
    const odo_pose after = coupling.on_vo_motion(motion_between(kSecond, 2 * kSecond, {0, 0, 0}), nullptr);
    const double turned = std::remainder(body_yaw(after) - yaw, 2 * EIGEN_PI);
    if (axis == 1)
      CHECK(std::abs(turned - 0.15) < 0.003);
    else
      CHECK(std::abs(turned) < 0.01);
  }
}

TEST_CASE("covariances without their valid flag are not read") {
  for (const auto orientation_by : {Orientation::vo, Orientation::gyroscope}) {
    PaperTrack coupling({.orientation = orientation_by}, {}, {true, true});
    coupling.on_first_frame(0);
    auto m = motion_between(0, kSecond, {0, 0, 0});
    for (double& c : m.covariance) c = std::numeric_limits<double>::quiet_NaN();
    coupling.on_vo_motion(m, nullptr);
    coupling.on_fix(yaw_fix_at(kSecond, 0, 0.1));
    const odo_pose pose = coupling.on_vo_motion(motion_between(kSecond, 2 * kSecond, {0, 0, 0}), nullptr);
    CHECK(orientation(pose).coeffs().allFinite());
    CHECK(std::isfinite(pose.covariance[14]));
  }
}

TEST_CASE("a fix whose position is rejected does not rotate the heading either") {
  PaperTrack coupling({}, {{0, 0, 0}, 0, true}, {true, true});
  coupling.on_calibration(forward_mount());
  const double before = body_yaw(coupling.on_first_frame(0));
  auto fix = yaw_fix_at(0, before + 0.1, 0.01);
  fix.header.flags |= ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  fix.p_n[0] = 500;
  fix.covariance_n[0] = fix.covariance_n[4] = 1;
  CHECK_FALSE(coupling.on_fix(fix).accepted);
  CHECK(body_yaw(coupling.on_vo_motion(motion_between(0, kSecond, {0, 0, 0}), nullptr)) == doctest::Approx(before));
}

TEST_CASE("a fix of the heading alone is published, with the state of the pose that it corrects") {
  TestFusion fusion({}, {}, {true, true});
  fusion->on_calibration(forward_mount());
  fusion.update(FrameTime{0});
  odo_pose first, corrected;
  REQUIRE(fusion.take_pose(first));
  const auto fix = yaw_fix_at(0, body_yaw(first) + 0.1, 0.01);
  CHECK(fusion.update(&fix).accepted);
  Correction correction;
  REQUIRE(fusion.take_correction(correction, corrected));
  CHECK(std::abs(std::remainder(body_yaw(corrected) - body_yaw(first), 2 * EIGEN_PI) - 0.1) < 0.002);
  CHECK(std::abs(log_rotation(correction.q).z() - 0.1) < 0.002);
  CHECK(correction.reason == ODO_CORRECTION_FIX);
  CHECK(corrected.state == first.state);
  CHECK(corrected.reason == first.reason);
}

TEST_CASE("a calibration before the first frame is the camera's mount") {
  for (const bool inertial : {false, true}) {
    TestFusion fusion({.type = inertial ? CouplingType::localizer : CouplingType::paper}, {}, {true, true});
    auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
    calibration.header.flags = ODO_CALIBRATION_EXTRINSICS;
    calibration.q_b_c[0] = 1;
    fusion->on_calibration(calibration);
    auto attitude = attitude_at(0);
    fusion.update(&attitude);
    fusion.update(FrameTime{0});
    odo_pose pose;
    REQUIRE(fusion.take_pose(pose));
    CHECK(orientation(pose).angularDistance(Quaterniond::Identity()) < 1e-6);
  }
}

TEST_CASE("a pose that stays behind is lost until its displacement or its position is measured") {
  PaperTrack coupling({}, {}, {true, true});
  coupling.on_first_frame(0);
  auto metre = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
  metre.scale = 1, metre.sigma = 0.1;
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, 0);
  fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  fix.covariance_n[0] = fix.covariance_n[4] = 1;
  int64_t t = 0;
  const auto then = [&](uint32_t state, uint32_t reason, const odo_scale* scale = nullptr) {
    odo_vo_motion m = motion_between(t, t + kSecond / 2, {0, 0, 0});
    if (state == ODO_TRACKING) m.p_c0_c1[2] = 1;
    if (state != ODO_TRACKING) m.header.flags &= ~ODO_VO_TRANSLATION;
    m.state = state, m.reason = reason, t += kSecond / 2;
    return coupling.on_vo_motion(m, scale);
  };
  CHECK(then(ODO_TRACKING, ODO_REASON_NONE, &metre).state == ODO_TRACKING);
  // A car stands at a light: no parallax, for as long as it stands.
  for (int k = 0; k < 10; ++k) CHECK(then(ODO_DEGRADED, ODO_REASON_NO_PARALLAX).state == ODO_DEGRADED);
  CHECK(then(ODO_TRACKING, ODO_REASON_NONE, &metre).state == ODO_TRACKING);
  // It drives under an empty sky, and nothing gives the scale: two seconds are bridged.
  for (int k = 0; k < 3; ++k) CHECK(then(ODO_TRACKING, ODO_REASON_NONE).state == ODO_DEGRADED);
  const odo_pose lost = then(ODO_TRACKING, ODO_REASON_NONE);
  CHECK(lost.state == ODO_LOST);
  CHECK(lost.reason == ODO_REASON_NO_SCALE);
  // Clouds have no parallax either, but the car is no longer where the pose is.
  CHECK(then(ODO_DEGRADED, ODO_REASON_NO_PARALLAX).state == ODO_LOST);
  fix.header.t_ns = t, fix.p_n[0] = 5;
  REQUIRE(coupling.on_fix(fix).accepted);
  CHECK(then(ODO_DEGRADED, ODO_REASON_NO_PARALLAX).state == ODO_DEGRADED);
  for (int k = 0; k < 4; ++k) then(ODO_LOST, ODO_REASON_FEW_FEATURES);
  CHECK(then(ODO_DEGRADED, ODO_REASON_NO_PARALLAX).state == ODO_LOST);
  CHECK(then(ODO_TRACKING, ODO_REASON_NONE, &metre).state == ODO_TRACKING);
}
