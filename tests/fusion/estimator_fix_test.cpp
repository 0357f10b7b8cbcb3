// SPDX-License-Identifier: Apache-2.0
//
// Updates by a fix and a scale, against the plain Kalman update with numeric derivatives.
#include <string_view>

#include <Eigen/LU>

#include "tests/support/measured_walk.hpp"
#include "tests/fusion/paper_track.hpp"
#include "tests/support/support.hpp"
#include "tests/support/messages.hpp"

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;

TEST_SUITE_BEGIN("estimator");

namespace {

constexpr int64_t kMillisecond = 1'000'000, kNow_ms = 1500;
constexpr uint32_t kAll = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN;
const Vector3d kLever_b(0.8, -0.5, 1.2);
const Vector3d kYawAxis_b(0.48, 0.6, -0.64);  // between a phone's top and its back
const Quaterniond kAskew = Quaterniond(0.5, 0.7, -0.3, 0.4).normalized(),
                  kTilted = Quaterniond(0.8, 0.3, -0.2, 0.35).normalized();

/// A tilted phone with a compass and a camera on a long lever arm, after 1.5 s of motion.
void fill(TestFusion& fusion, bool metric = true) {
  auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  calibration.header.flags = ODO_CALIBRATION_EXTRINSICS;
  put_quaternion(kAskew, calibration.q_b_c);
  Vector3d::Map(calibration.p_b_c) = kLever_b;
  fusion->on_calibration(calibration);
  for (int64_t ms = 0; ms <= kNow_ms; ms += 10) {
    auto attitude = attitude_at(ms * kMillisecond, kTilted, 0.05 * 0.05);
    attitude.header.flags = ODO_ATTITUDE_MAGNETIC_NORTH, attitude.covariance_n[8] = 0.3 * 0.3;
    fusion->on_imu(imu_at(ms * kMillisecond, {0, 0, 0}, kTilted.conjugate() * Vector3d(2, -1, -9.81)));
    if (ms == 0) fusion.update(&attitude);
    if (ms == 500) fusion.update(FrameTime{ms * kMillisecond});
    if (ms <= 500 || ms % 100 != 0) continue;
    auto motion = motion_between((ms - 100) * kMillisecond, ms * kMillisecond,
                                 {0.12, 0, 0.05 * std::sin(static_cast<double>(ms))},
                                 ODO_VO_ROTATION | ODO_VO_TRANSLATION | (metric ? ODO_VO_METRIC : 0));
    motion.scale_sigma = 0.02;
    fusion.update(RelativeMotion{&motion, nullptr});
  }
}

/// The measurement of a fix with these flags for a body with errors of (heading, position).
VectorXd measured(uint32_t flags, const KeptPose& at, const Vector4d& error) {
  const Quaterniond q = exp_rotation(Vector3d(0, 0, error[0])) * at.q_n_b;
  const Vector3d p = at.p_n_b + error.tail<3>() + q * kLever_b;
  VectorXd z(0);
  const auto add = [&](double value) { z.conservativeResize(z.size() + 1), z[z.size() - 1] = value; };
  if (flags & ODO_FIX_ORIENTATION)
    add(error[0]);
  else if (flags & ODO_FIX_YAW)
    add(std::atan2((q * kYawAxis_b).y(), (q * kYawAxis_b).x()));
  for (int i = 0; i < 3; ++i)
    if (flags & (ODO_FIX_NORTH << i)) add(p[i]);
  return z;
}

/// A fix with a small residual, the covariance of its rows, and the residual.
odo_fix a_fix(uint32_t flags, int64_t t_ns, const KeptPose& at, MatrixXd& noise, VectorXd& residual) {
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, t_ns);
  fix.header.flags = flags | ODO_FIX_LEVER;
  Vector3d::Map(fix.yaw_axis_b) = kYawAxis_b, Vector3d::Map(fix.lever_b) = kLever_b;
  constexpr double kOff_rad = 1.5e-4, kYawSigma_rad = 0.07;
  const Vector3d off(2e-4, 1e-4, -3e-4);
  Matrix3d R, Q;
  R << 0.04, 0.01, -0.008, 0.01, 0.03, 0.006, -0.008, 0.006, 0.05;
  Q = 0.02 * R;
  Matrix3d::Map(fix.covariance_n) = R, Matrix3d::Map(fix.orientation_cov_n) = Q;
  const Vector3d y = at.q_n_b * kYawAxis_b;
  fix.yaw_rad = std::atan2(y.y(), y.x()) + kOff_rad, fix.yaw_sigma_rad = kYawSigma_rad;
  const Quaterniond q = exp_rotation(Vector3d(0, 0, kOff_rad)) * at.q_n_b;
  put_quaternion(q, fix.q_n_b);
  // The fix's own orientation, if any, rotates the lever.
  Vector3d::Map(fix.p_n) = at.p_n_b + (flags & ODO_FIX_ORIENTATION ? q : at.q_n_b) * kLever_b + off;
  std::vector<int> axes;
  for (int i = 0; i < 3; ++i)
    if (flags & (ODO_FIX_NORTH << i)) axes.push_back(i);
  const Eigen::Index first = flags & (ODO_FIX_ORIENTATION | ODO_FIX_YAW) ? 1 : 0;
  const Eigen::Index n = first + static_cast<Eigen::Index>(axes.size());
  noise = MatrixXd::Zero(n, n), residual = VectorXd::Zero(n);
  if (first == 1) noise(0, 0) = flags & ODO_FIX_ORIENTATION ? Q(2, 2) : squared(kYawSigma_rad), residual[0] = kOff_rad;
  for (size_t i = 0; i < axes.size(); ++i) {
    residual[first + static_cast<Eigen::Index>(i)] = off[axes[i]];
    for (size_t j = 0; j < axes.size(); ++j)
      noise(first + static_cast<Eigen::Index>(i), first + static_cast<Eigen::Index>(j)) = R(axes[i], axes[j]);
  }
  return fix;
}

}  // namespace

TEST_CASE("a fix of any kind, present or late, is the Kalman update with its measurement") {
  for (const uint32_t flags :
       {kAll, uint32_t{ODO_FIX_NORTH | ODO_FIX_EAST}, uint32_t{ODO_FIX_DOWN}, uint32_t{ODO_FIX_YAW},
        uint32_t{ODO_FIX_ORIENTATION}, kAll | ODO_FIX_ORIENTATION, kAll | ODO_FIX_YAW})
    for (const int64_t ago_ms : {0, 170}) {
      CAPTURE(flags);
      CAPTURE(ago_ms);
      TestFusion fusion({.type = CouplingType::localizer},
                        {.position_m = {1, 2, 3}, .given = true, .heading_given = true}, {true, false});
      fill(fusion);
      const int64_t t_ns = (kNow_ms - ago_ms) * kMillisecond;
      const uint64_t id = fusion->keep_pose(t_ns).pose_id;
      KeptPose before, after, now, later;
      REQUIRE(fusion->kept_pose(id, before));
      REQUIRE(fusion->pose_now(now));
      MatrixXd R, H, P(8, 8);
      VectorXd residual;
      const odo_fix fix = a_fix(flags, t_ns, before, R, residual);
      H = MatrixXd::Zero(residual.size(), 8);
      constexpr double h = 1e-6;
      for (int i = 0; i < 4; ++i)
        H.col(i) = (measured(flags, before, h * Vector4d::Unit(i)) - measured(flags, before, -h * Vector4d::Unit(i))) /
                   (2 * h);
      const auto joint = [](const KeptPose& of) {
        MatrixXd out(8, 8);
        out << of.own.block<4, 4>(2, 2), of.cross.block<4, 4>(2, 2), of.cross.block<4, 4>(2, 2).transpose(),
            of.now.block<4, 4>(2, 2);
        return out;
      };
      P = joint(before);
      const MatrixXd S = H * P * H.transpose() + R, K = P * H.transpose() * S.inverse(), expected = P - K * H * P;
      const VectorXd moved = K * residual;
      const UpdateResult result = fusion.update(&fix);
      REQUIRE(result.accepted);
      CHECK(result.dof == residual.size());
      CHECK(result.nis / residual.dot(S.inverse() * residual) == doctest::Approx(1).epsilon(1e-3));
      REQUIRE(fusion->kept_pose(id, after));
      REQUIRE(fusion->pose_now(later));
      CHECK((joint(after) - expected).norm() < 1e-4 * (P - expected).norm());
      VectorXd stated_move(8);
      stated_move << log_rotation(after.q_n_b * before.q_n_b.conjugate()).z(), after.p_n_b - before.p_n_b,
          log_rotation(later.q_n_b * now.q_n_b.conjugate()).z(), later.p_n_b - now.p_n_b;
      CHECK((stated_move - moved).norm() < 1e-3 * moved.norm());
    }
}

TEST_CASE(
    "a scale that is reported repeatedly contributes the information lost by decay since its last report, and no "
    "more") {
  const Scale::Parameters p;
  TestFusion fusion({.type = CouplingType::localizer}, {}, {true, true});
  fill(fusion, false);
  auto motion = motion_between((kNow_ms - 100) * kMillisecond, kNow_ms * kMillisecond, {0, 0, 0});
  fusion.update(RelativeMotion{&motion, nullptr});
  constexpr double kSigma = 0.05;
  const auto information = [&] { return 1 / std::pow(fusion.filter().sigma(kLogScale), 2); };
  double last_s = 0;
  for (const double t_s : {0.0, 2.0, 3.0, 8.0, 9.0, 10.0, 40.0, 41.0}) {
    CAPTURE(t_s);
    auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, kNow_ms * kMillisecond + static_cast<int64_t>(t_s * 1e9));
    scale.scale = 2, scale.sigma = 2 * kSigma;
    const double before = information();
    CHECK(fusion.update(&scale).accepted);
    const double forgotten = 1 - std::exp(-(t_s - last_s) / p.memory_s), told = 1 / (kSigma * kSigma);
    if (t_s == 0)
      CHECK(information() == doctest::Approx(told).epsilon(1e-6));
    else
      CHECK(information() - before == doctest::Approx(told * forgotten).epsilon(1e-3));
    last_s = t_s;
  }
  CHECK(fusion.filter().x()[kLogScale] == doctest::Approx(std::log(2)));
}

TEST_CASE("a late fix is compared with its position as corrected by all later fixes, in their order") {
  PaperTrack coupling({.fix_gate_sigma = 0}, {.position_m = {0, 0, 0}, .given = true}, {true, true});
  auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, 0);
  scale.header.flags = ODO_SCALE_HORIZONTAL;
  scale.scale = 1, scale.sigma = 0.2;
  coupling.on_first_frame(0);
  odo_pose pose{}, then{};
  const auto walk_to = [&](int64_t s) {
    auto m = motion_between((s - 1) * 1000 * kMillisecond, s * 1000 * kMillisecond, {0, 0, 5},
                            ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_COVARIANCE);
    for (int i = 0; i < 3; ++i) m.covariance[7 * i] = 0.1 * 0.1;
    pose = coupling.on_vo_motion(m, &scale);
  };
  std::vector<std::function<Vector3d(const Vector3d&)>> corrections;
  const auto correct = [&](double yaw_rad, const Vector3d& by_n) {
    auto fix = make_message<odo_fix>(ODO_TYPE_FIX, pose.header.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_YAW, fix.yaw_axis_b[1] = 1;
    const Vector3d y = quaternion(pose.q_n) * Quaterniond(0, 1, 0, 0) * Vector3d::UnitY();
    fix.yaw_rad = std::atan2(y.y(), y.x()) + yaw_rad, fix.yaw_sigma_rad = 0.01;
    Vector3d::Map(fix.p_n) = Vector3d(pose.p_n) + by_n;
    fix.covariance_n[0] = fix.covariance_n[4] = 0.01;
    REQUIRE(coupling.on_fix(fix).accepted);
    const auto after = required(coupling.take_correction());
    const Quaterniond turned = quaternion(after->q_n) * quaternion(pose.q_n).conjugate();
    corrections.push_back([turned, from = Vector3d(pose.p_n), to = Vector3d(after->p_n)](
                              const Vector3d& p) -> Vector3d { return to + turned * (p - from); });
    CHECK(turned.angularDistance(Quaterniond::Identity()) > 0.1);
    pose = *after;
  };
  walk_to(1), walk_to(2), then = pose, walk_to(3);
  correct(0.4, {1, 2, 0});
  walk_to(4), correct(-0.3, {-2, 1, 0});
  walk_to(5), correct(0.25, {0.5, -1.5, 0});
  Vector3d expected(then.p_n);
  for (const auto& correction : corrections) expected = correction(expected);
  auto late = make_message<odo_fix>(ODO_TYPE_FIX, then.header.t_ns);
  late.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  late.covariance_n[0] = late.covariance_n[4] = 1e-4;
  Vector3d::Map(late.p_n) = expected;
  CHECK((expected - Vector3d(then.p_n)).norm() > 1);
  CHECK(coupling.on_fix(late).nis < 1e-12);
}

TEST_CASE("a fix before the camera's first frame keeps its place when the camera starts") {
  for (const CouplingType type : {CouplingType::localizer, CouplingType::paper}) {
    TestFusion fusion({.type = type}, {}, {true, false});
    auto attitude = attitude_at(0, Quaterniond::Identity(), 1e-4);
    fusion.update(&attitude);
    auto fix = make_message<odo_fix>(ODO_TYPE_FIX, 0);
    fix.header.flags = kAll | ODO_FIX_COVARIANCE;
    fix.p_n[0] = 100, fix.p_n[1] = -50, fix.p_n[2] = -3;
    fix.covariance_n[0] = fix.covariance_n[4] = fix.covariance_n[8] = 1;
    REQUIRE(fusion.update(&fix).accepted);
    fusion.update(FrameTime{100'000'000});
    Estimate now;
    REQUIRE(fusion.at({}, now) == ODO_OK);
    CHECK((now.p_n_b - Vector3d(100, -50, -3)).norm() < 1e-9);
  }
}

TEST_CASE("a first height moves the barometer's offset and no floor") {
  for (const double height_m : {7.0, 300.0}) {
    CAPTURE(height_m);
    TestFusion fusion({.type = CouplingType::localizer}, {}, {false, false});
    int used = 0, floor_notices = 0;
    double time_s = 0;
    const auto stand = [&](double until_s) {
      for (; time_s < until_s; time_s += 0.1) {
        const auto t_ns = static_cast<int64_t>(time_s * 1e9);
        auto attitude = attitude_at(t_ns, Quaterniond::Identity(), 1e-4);
        auto barometer = pressure_at(t_ns, 95'000);
        fusion.update(&attitude);
        used += fusion.update(&barometer).accepted;
      }
      for (Notice notice = fusion.take_notice(); notice.key; notice = fusion.take_notice())
        floor_notices += std::string_view(notice.key) == "floor";
    };
    stand(20);
    const int before = used;
    auto fix = make_message<odo_fix>(ODO_TYPE_FIX, 19'900'000'000);
    fix.header.flags = ODO_FIX_DOWN | ODO_FIX_COVARIANCE;
    fix.p_n[2] = -height_m, fix.covariance_n[8] = 0.25;
    REQUIRE(fusion.update(&fix).accepted);
    stand(40);
    CHECK(used - before == 200);
    CHECK(std::abs(fusion.filter().x()[kDown] + height_m) < 0.5);
    CHECK(fusion->floor().floor == 0);
    CHECK(floor_notices == 0);
  }
}
