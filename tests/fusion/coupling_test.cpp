// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/step_fit/step_fit.hpp"
#include "plugins/scale/step_length/step_scale.hpp"
#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/fusion/paper_track.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("coupling");

namespace {

constexpr int64_t kSecond = 1'000'000'000;

odo_scale scale(double scale) {
  auto s = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
  s.scale = scale;
  s.sigma = 0.1 * scale;
  s.header.flags = ODO_SCALE_HORIZONTAL;
  return s;
}

/// The fix with the orientation of a camera that is rotated by `yaw_rad` from a pose.
odo_fix oriented(odo_fix fix, const odo_pose& pose, double yaw_rad, double sigma_rad) {
  fix.header.flags |= ODO_FIX_ORIENTATION | ODO_FIX_ORIENTATION_COVARIANCE;
  const Eigen::Quaterniond q_n_c(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]), q_b_c(0, 1, 0, 0);
  put_quaternion(Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ())) * q_n_c * q_b_c.conjugate(),
                 fix.q_n_b);
  for (const int i : {0, 4, 8}) fix.orientation_cov_n[i] = sigma_rad * sigma_rad;
  return fix;
}

}  // namespace

TEST_CASE("eq. (6): a step's length is used during the following step") {
  step_scale::StepInterpolation steps(1.6);
  CHECK_FALSE(steps.between(0, kSecond / 10).has_value());
  steps.add_step(0, kSecond / 2, 0.70, 0.05);               // step 1: 1.4 m/s, in force from 0.5 s on
  CHECK_FALSE(steps.between(0, kSecond / 10).has_value());  // before any step was complete
  CHECK(steps.between(kSecond / 2, kSecond * 6 / 10)->metres == doctest::Approx(0.14));
  steps.add_step(kSecond / 2, kSecond, 0.60, 0.05);  // step 2: 1.2 m/s, in force from 1.0 s on
  // An interval across the end of step 2: half at step 1's speed, half at step 2's.
  CHECK(steps.between(kSecond * 95 / 100, kSecond * 105 / 100)->metres == doctest::Approx(0.05 * 1.4 + 0.05 * 1.2));
  // Over step 3 the displacement equals step 2's length if both have the same duration.
  CHECK(steps.between(kSecond, kSecond * 3 / 2)->metres == doctest::Approx(0.60));
}

TEST_CASE("a walker who stops stands, until the next step") {
  step_scale::StepInterpolation steps(1.6);
  steps.add_step(0, kSecond / 2, 0.70, 0.05);
  CHECK(steps.between(2 * kSecond, 3 * kSecond)->metres == 0.0);
  steps.stand(kSecond * 6 / 10);
  CHECK(steps.between(kSecond / 2, kSecond)->metres == doctest::Approx(0.14));
  steps.add_step(2 * kSecond, kSecond * 5 / 2, 0.70, 0.05);
  CHECK(steps.between(kSecond * 5 / 2, kSecond * 26 / 10)->metres == doctest::Approx(0.14));
}

TEST_CASE("each displacement is scaled separately, horizontally, in NED") {
  PaperTrack coupling({}, {}, {true, true});
  const odo_pose first = coupling.on_first_frame(0);
  // Without attitude the camera starts horizontal, facing north: z forward is north, x right is east, y down is down.
  Eigen::Quaterniond q(first.q_n[0], first.q_n[1], first.q_n[2], first.q_n[3]);
  CHECK((q * Vector3d::UnitZ() - Vector3d::UnitX()).norm() < 1e-12);
  CHECK((q * Vector3d::UnitX() - Vector3d::UnitY()).norm() < 1e-12);
  const odo_scale s = scale(2.0);
  odo_pose pose = coupling.on_vo_motion(motion_between(0, kSecond, {0.1, 0.2, 0.5}), &s);
  CHECK(pose.p_n[0] == doctest::Approx(1.0));
  CHECK(pose.p_n[1] == doctest::Approx(0.2));
  CHECK(pose.p_n[2] == 0.0);  // the vertical displacement is ignored, as in the paper
  CHECK(pose.state == ODO_TRACKING);
  CHECK((pose.header.flags & ODO_POSE_METRIC) != 0);
  pose = coupling.on_vo_motion(motion_between(kSecond, 2 * kSecond, {0, 0, 1}), nullptr);
  CHECK(pose.state == ODO_DEGRADED);
  CHECK(pose.reason == ODO_REASON_NO_SCALE);
  CHECK(pose.p_n[0] == doctest::Approx(1.0));  // unchanged
  CHECK(coupling.distance_m() == doctest::Approx(std::hypot(1.0, 0.2)));
}

TEST_CASE("the vertical displacement is that of the terrain, whatever the odometry's own is") {
  // Antigny et al. 2019, section 3.3: the odometry's vertical displacement d_VO has the scale d_DTM / d_VO, so that the
  // scaled one is d_VO * d_DTM / d_VO = d_DTM. The track gets that from fix/terrain, once a frame with the sigmas of
  // antigny2019.yaml. 1 m of slope 0.05 a frame: after 40 frames 2 m up.
  PaperTrack coupling({.fix_gate_sigma = 100}, {}, {true, true});
  coupling.on_first_frame(0);
  constexpr double kHeld_m = 1.53, kSigma_m = 0.01005, kSlope = 0.05;
  const auto ground_fix = [&](int64_t t_ns, double north_m) {
    return fix_at(t_ns, {0, 0, -kHeld_m - kSlope * north_m}, kSigma_m, ODO_FIX_DOWN | ODO_FIX_COVARIANCE);
  };
  REQUIRE(coupling.on_fix(ground_fix(0, 0)).accepted);
  const double start_m = coupling.take_correction()->p_n[2];
  const odo_scale s = scale(2.0);
  for (int k = 0; k < 40; ++k) {
    const int64_t from = k * kSecond, to = from + kSecond;
    const odo_pose pose = coupling.on_vo_motion(motion_between(from, to, {0, 0.3, 0.5}), &s);  // 0.3 downwards
    REQUIRE(coupling.on_fix(ground_fix(to, pose.p_n[0])).accepted);
  }
  odo_pose end{};
  REQUIRE(coupling.pose_at(40 * kSecond, end) == ODO_OK);
  CHECK(end.p_n[0] == doctest::Approx(40));
  CHECK(std::abs(end.p_n[2] - start_m + 2.0) < 0.02);
}

TEST_CASE("rotations are composed from frame to frame") {
  PaperTrack coupling({}, {}, {true, false});
  coupling.on_first_frame(0);
  auto rotation = motion_between(0, kSecond, Vector3d::Zero());
  const Eigen::Quaterniond right(Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitY()));  // about the camera's down axis
  rotation.q_c0_c1[0] = right.w(), rotation.q_c0_c1[2] = right.y();
  coupling.on_vo_motion(rotation, nullptr);
  const odo_pose pose = coupling.on_vo_motion(motion_between(kSecond, 2 * kSecond, {0, 0, 3}), nullptr);
  CHECK(pose.p_n[0] == doctest::Approx(0.0));
  CHECK(pose.p_n[1] == doctest::Approx(3.0));  // facing east now; up to scale, no scale source
  CHECK((pose.header.flags & ODO_POSE_METRIC) == 0);
}

TEST_CASE("the first fix sets the track, later ones correct it by their weight, and wrong ones are rejected") {
  CouplingConfig config;
  PaperTrack coupling(config, {}, {true, true});
  coupling.on_first_frame(0);
  CHECK(coupling.on_fix(fix_at(0, {100, 50, 0}, 1.0)).accepted);
  odo_pose pose = *coupling.take_correction();
  CHECK(pose.p_n[0] == doctest::Approx(100).epsilon(1e-6));
  const odo_scale s = scale(1.0);
  pose = coupling.on_vo_motion(motion_between(0, kSecond, {0, 0, 10}), &s);
  CHECK(pose.p_n[0] == doctest::Approx(110));
  CHECK_FALSE(coupling.on_fix(fix_at(kSecond, {150, 50, 0}, 1.0)).accepted);
  CHECK_FALSE(coupling.take_correction().has_value());
  CHECK(coupling.on_fix(fix_at(kSecond, {111, 50, 0}, 1.0)).accepted);
  pose = *coupling.take_correction();
  CHECK(pose.p_n[0] == Between{110.2, 111.0});
  // The uncertainty along the path was that of the scale: the correction reduces it.
  CHECK(pose.covariance[3 * 6 + 3] < 1.0);
}

TEST_CASE("a wrong track finally follows the fixes") {
  PaperTrack coupling({}, {}, {true, true});
  coupling.on_first_frame(0);
  REQUIRE(coupling.on_fix(fix_at(0, {0, 0, 0}, 0.5)).accepted);
  int needed = 0;
  while (!coupling.on_fix(fix_at(0, {500, 0, 0}, 0.5)).accepted) REQUIRE(++needed < 20);
  CHECK(coupling.take_correction()->p_n[0] == doctest::Approx(500).epsilon(1e-3));
}

TEST_CASE("an orientation fix rotates the track by its weight, and an absurd one is ignored") {
  PaperTrack coupling({}, {}, {true, true});
  const odo_pose first = coupling.on_first_frame(0);
  const auto fix_of = [&](double yaw, double sigma) {
    return oriented(make_message<odo_fix>(ODO_TYPE_FIX, 0), first, yaw, sigma);
  };
  CHECK_FALSE(coupling.on_fix(fix_of(2.5, 0.01)).accepted);
  CHECK(coupling.on_fix(fix_of(0.1, 0.002)).accepted);
  const odo_scale s = scale(1.0);
  const odo_pose pose = coupling.on_vo_motion(motion_between(0, kSecond, {0, 0, 1}), &s);
  CHECK(std::abs(std::atan2(pose.p_n[1], pose.p_n[0]) - 0.1) < 0.001);
  CHECK(coupling.on_fix(fix_of(0.102, 0.05)).accepted);  // a less accurate one hardly moves it
  CHECK(pose.covariance[14] < 0.01 * 0.01);
}

TEST_CASE("the fix that sets a track may rotate it to any heading, later ones may not") {
  PaperTrack coupling({}, {}, {true, true});
  const odo_pose first = coupling.on_first_frame(0);
  const auto fix_of = [&](int64_t t, double yaw, double north) {
    return oriented(fix_at(t, {north, 7, 0}, 0.5), first, yaw, 0.01);
  };
  REQUIRE(coupling.on_fix(fix_of(0, 2.5, 100)).accepted);
  const odo_scale s = scale(1.0);
  const odo_pose pose = coupling.on_vo_motion(motion_between(0, kSecond, {0, 0, 8}), &s);
  CHECK(std::atan2(pose.p_n[1] - 7, pose.p_n[0] - 100) == doctest::Approx(2.5).epsilon(0.01));
  coupling.on_fix(fix_of(kSecond, 0.0, pose.p_n[0]));
  const odo_pose after = coupling.on_vo_motion(motion_between(kSecond, 2 * kSecond, {0, 0, 8}), &s);
  CHECK(std::atan2(after.p_n[1] - pose.p_n[1], after.p_n[0] - pose.p_n[0]) == doctest::Approx(2.5).epsilon(0.05));
}

TEST_CASE("a late heading fix rotates the path since its time, and an older fix accounts for it") {
  PaperTrack coupling({}, {}, {true, true});
  coupling.on_first_frame(0);
  const odo_scale s = scale(1.0);
  for (int k = 0; k < 10; ++k) coupling.on_vo_motion(motion_between(k * kSecond, (k + 1) * kSecond, {0, 0, 10}), &s);
  odo_pose now{};
  REQUIRE(coupling.pose_at(10 * kSecond, now) == ODO_OK);
  const Eigen::Quaterniond q(now.q_n[0], now.q_n[1], now.q_n[2], now.q_n[3]);
  const Vector3d y_n = (q * Eigen::Quaterniond(0, 1, 0, 0).conjugate()) * Vector3d::UnitY();
  auto fix = fix_at(2 * kSecond, {20, 0, 0}, 0.5);  // the true heading was 0.3 rad farther to the right
  fix.header.flags |= ODO_FIX_YAW, fix.yaw_axis_b[1] = 1;
  fix.yaw_sigma_rad = 0.01;
  fix.yaw_rad = std::atan2(y_n.y(), y_n.x()) + 0.3;
  REQUIRE(coupling.on_fix(fix).accepted);
  const odo_pose turned = *coupling.take_correction();
  const double yaw = std::atan2(turned.p_n[1], turned.p_n[0] - 20);
  CHECK(yaw == Between{0.29, 0.31});
  CHECK(std::hypot(turned.p_n[0] - 20, turned.p_n[1]) == doctest::Approx(80).epsilon(0.01));
  // A second fix at 6 s at the position of the corrected track changes nothing.
  REQUIRE(coupling.on_fix(fix_at(6 * kSecond, {20 + 40 * std::cos(yaw), 40 * std::sin(yaw), 0}, 0.5)).accepted);
  const odo_pose same = coupling.take_correction().value_or(turned);
  CHECK((Vector3d(same.p_n) - Vector3d(turned.p_n)).norm() < 0.1);
}

TEST_CASE("without a scale the position's uncertainty grows with the maximum speed, until a fix") {
  PaperTrack coupling({.fastest_mps = 10}, {{0, 0, 0}, 0, true}, {true, true});
  coupling.on_first_frame(0);
  odo_pose pose = coupling.on_vo_motion(motion_between(0, kSecond, {0, 0, 1}), nullptr);
  CHECK(std::sqrt(pose.covariance[3 * 6 + 3]) == doctest::Approx(10));
  CHECK(pose.state == ODO_DEGRADED);
  CHECK(coupling.on_fix(fix_at(kSecond, {8, 0, 0}, 0.5)).accepted);
  CHECK(coupling.take_correction()->p_n[0] == doctest::Approx(8).epsilon(0.01));
  const odo_scale s = scale(2.0);
  pose = coupling.on_vo_motion(motion_between(kSecond, 2 * kSecond, {0, 0, 1}), &s);
  CHECK(std::sqrt(pose.covariance[4 * 6 + 4]) < 1);
}

TEST_CASE("without a scale the uncertainty grows from the newest fix on, also one in the first second") {
  PaperTrack coupling({.fastest_mps = 10}, {{0, 0, 0}, 0, true}, {true, true});
  coupling.on_first_frame(0);
  coupling.on_vo_motion(motion_between(0, kSecond / 2, {0, 0, 0.1}), nullptr);
  REQUIRE(coupling.on_fix(fix_at(kSecond / 2, {0.1, 0, 0}, 0.5)).accepted);
  const auto sigma_m = [](const odo_pose& pose) { return std::sqrt(pose.covariance[3 * 6 + 3]); };
  odo_pose pose = coupling.on_vo_motion(motion_between(kSecond / 2, kSecond, {0, 0, 0.1}), nullptr);
  CHECK(sigma_m(pose) == doctest::Approx(5).epsilon(0.02));  // 0.5 s at 10 m/s, not 1 s
  REQUIRE(coupling.on_fix(fix_at(kSecond, {0.2, 0, 0}, 0.5)).accepted);
  // Fixes twice a second leave half a second of unknown motion between them, which is less than the second after which
  // steps would have been heard of; it counts all the same.
  pose = coupling.on_vo_motion(motion_between(kSecond, 3 * kSecond / 2, {0, 0, 0.1}), nullptr);
  CHECK(sigma_m(pose) == doctest::Approx(5).epsilon(0.02));
}

TEST_CASE("a pose is flagged metric and with velocity only if valid, and the first scale announces its correction") {
  TestFusion fusion({}, {}, {true, true});
  const auto flags_after = [&](const auto& measurement) {
    fusion.update(measurement);
    odo_pose pose;
    REQUIRE(fusion.take_pose(pose));
    return pose.header.flags & (ODO_POSE_METRIC | ODO_POSE_VELOCITY);
  };
  CHECK(flags_after(FrameTime{0}) == 0);
  auto first = motion_between(0, kSecond / 10, {0, 0, 0.1}),
       second = motion_between(kSecond / 10, kSecond / 5, {0, 0, 0.1});
  CHECK(flags_after(RelativeMotion{&first, nullptr}) == 0);  // no scale yet
  auto late = scale(2.0);
  late.header.flags |= ODO_SCALE_STEADY;
  fusion.update(RelativeMotion{&second, &late});
  Correction correction;
  odo_pose pose;
  REQUIRE(fusion.take_correction(correction, pose));
  CHECK(correction.reason == ODO_CORRECTION_SCALE);
  CHECK(correction.p.norm() == doctest::Approx(0.2));  // the first motion, in metres
  REQUIRE(fusion.take_pose(pose));
  CHECK((pose.header.flags & ODO_POSE_METRIC) != 0);
  CHECK((pose.header.flags & ODO_POSE_VELOCITY) != 0);
  auto blind = motion_between(kSecond / 5, kSecond * 3 / 10, {0, 0, 0});
  blind.header.flags = 0;
  blind.state = ODO_LOST;
  CHECK(flags_after(RelativeMotion{&blind, nullptr}) == ODO_POSE_METRIC);  // metric, but of unknown speed
}

TEST_CASE("steps carry the position without a camera") {
  PaperTrack coupling({}, {{10, 20, 0}, EIGEN_PI / 2, true}, {false, false});
  REQUIRE(coupling.on_attitude(attitude_at(0)).has_value());
  const auto pose = required(coupling.on_step(step_between(0, kSecond / 2, kSecond, 0.7, 0.07)));
  CHECK(pose->p_n[0] == doctest::Approx(10));
  CHECK(pose->p_n[1] == doctest::Approx(20.7));  // the initial heading is east
  CHECK(std::sqrt(pose->covariance[4 * 6 + 4]) == doctest::Approx(0.7 * std::hypot(0.1, 0.06)).epsilon(0.01));
  odo_pose later{};
  CHECK(coupling.pose_at(kSecond / 4, later) == ODO_OK);
  CHECK(later.p_n[1] == doctest::Approx(20.35));
  CHECK(coupling.pose_at(-1, later) == ODO_E_NOT_FOUND);
  CHECK(coupling.pose_at(kSecond + 500'000'001, later) == ODO_E_NOT_FOUND);  // not extrapolated by more than 0.5 s
}

TEST_CASE("the coupling composes the gyroscope's rotations if configured") {
  PaperTrack coupling({.orientation = Orientation::gyroscope}, {}, {.vo = true, .scale = false});
  coupling.on_attitude(attitude_at(0));
  coupling.on_first_frame(0);
  for (int k = -1; k < 200; ++k) {  // a turn of 90 degrees within a second
    coupling.on_imu(imu_at((k + 1) * 5'000'000LL, {0, 0, EIGEN_PI / 2}, {0, 0, -9.81}));
  }
  auto no_picture = motion_between(0, kSecond, {0, 0, 0});
  no_picture.header.flags = 0;
  const odo_pose pose = coupling.on_vo_motion(no_picture, nullptr);
  const Eigen::Quaterniond camera(0, 1, 0, 0);  // its default mount
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitZ()));
  CHECK(Eigen::Quaterniond(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]).angularDistance(expected * camera) <
        1e-3);
}

TEST_CASE("a fix may turn a gyroscope heading of unknown origin around, but not one referred to north") {
  for (const bool told : {false, true}) {
    CAPTURE(told);
    PaperTrack coupling({.orientation = Orientation::gyroscope},
                        {.position_m = {0, 0, 0}, .heading_rad = 0, .given = true, .heading_given = told},
                        {.vo = true, .scale = false});
    coupling.on_attitude(attitude_at(0));
    coupling.on_first_frame(0);
    CHECK(coupling.on_fix(yaw_fix_at(0, -2.5, 0.02)).accepted == !told);
  }
}

TEST_CASE("a motion faster than the carrier's maximum is rejected") {
  PaperTrack coupling({.fastest_mps = 2}, {}, {.vo = true, .scale = true});
  coupling.on_first_frame(0);
  const odo_scale metre = scale(1.0);
  const odo_pose walked = coupling.on_vo_motion(motion_between(0, kSecond / 10, {0.15, 0, 0}), &metre);
  CHECK(walked.distance_m == doctest::Approx(0.15));
  const odo_pose leapt = coupling.on_vo_motion(motion_between(kSecond / 10, kSecond / 5, {3.0, 0, 0}), &metre);
  CHECK(leapt.distance_m == doctest::Approx(0.15));
  CHECK(leapt.state == ODO_DEGRADED);
  CHECK(leapt.reason == ODO_REASON_TOO_FAST);
}

TEST_CASE("one scale from all steps: gestures are ignored, step errors average out, and a new group restarts it") {
  step_fit::StepFit fit(0.004, 0.05);
  const double scale = 4.0;
  int64_t t = 0;
  double x = 0;
  const auto move = [&](double metres) {
    fit.add_motion(t, t + kSecond / 10, Eigen::Vector2d(metres / scale, 0), 0);
    t += kSecond / 10, x += metres;
  };
  for (int k = 0; k < 40; ++k) {  // standing: the hand moves and the detector counts steps
    move(k % 10 < 5 ? 0.02 : -0.02);
    if (k % 5 == 4) CHECK_FALSE(fit.add_step(t - kSecond / 2, t, 0.6, 0.05));
  }
  CHECK_FALSE(fit.scale());
  int counted = 0;
  for (int step = 0; step < 40; ++step) {
    for (int k = 0; k < 5; ++k) move(0.14);
    counted += fit.add_step(t - kSecond / 2, t, step % 2 ? 0.62 : 0.78, 0.07);  // mean 0.7
    if (step == 0) CHECK_FALSE(fit.scale());
  }
  CHECK(counted >= 37);
  REQUIRE(fit.scale());
  CHECK(fit.scale()->scale == doctest::Approx(scale).epsilon(0.03));
  CHECK(fit.scale()->relative_sigma < 0.08);
  CHECK_FALSE(fit.add_step(t, t + kSecond, 0.7, 0.07));  // not yet covered by the odometry
  fit.add_motion(t, t + kSecond / 10, {0.1, 0}, 1);
  CHECK_FALSE(fit.scale());
}

TEST_CASE("a steady scale also applies to earlier motions of its group, a frame's own scale does not") {
  for (const bool steady : {true, false}) {
    PaperTrack coupling({.fastest_mps = 20}, {.position_m = {0, 0, 0}, .heading_rad = 0, .given = true},
                        {.vo = true, .scale = true});
    coupling.on_first_frame(0);
    for (int k = 0; k < 10; ++k)
      coupling.on_vo_motion(motion_between(k * kSecond, (k + 1) * kSecond, {0, 0, 0.5}), nullptr);
    odo_scale two = scale(2.0);
    if (steady) two.header.flags |= ODO_SCALE_STEADY;
    const odo_pose pose = coupling.on_vo_motion(motion_between(10 * kSecond, 11 * kSecond, {0, 0, 0.5}), &two);
    CHECK(pose.distance_m == doctest::Approx(steady ? 11.0 : 1.0));
    const odo_pose next = coupling.on_vo_motion(motion_between(11 * kSecond, 12 * kSecond, {0, 0, 0.5}), &two);
    CHECK(next.distance_m == doctest::Approx(steady ? 12.0 : 2.0));
  }
}

TEST_CASE("a camera that is lost before it ever tracked is reported lost, without bridging") {
  PaperTrack coupling({}, {}, {true, true});
  coupling.on_attitude(attitude_at(5 * kSecond));
  auto blind = motion_between(5 * kSecond - kSecond / 10, 5 * kSecond, Vector3d::Zero());
  blind.state = ODO_LOST;
  CHECK(coupling.on_vo_motion(blind, nullptr).state == ODO_LOST);
}
