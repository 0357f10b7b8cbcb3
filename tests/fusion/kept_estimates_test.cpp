// SPDX-License-Identifier: Apache-2.0
//
// Kept estimates (docs/testing.md, "Kept results"): the fusion on a simulated walk, by both rules, with every kind of
// input and all outputs of an estimator, including whole covariances.
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/measured_walk.hpp"
#include "tests/support/kept.hpp"
#include "tests/support/messages.hpp"

namespace {

constexpr Tolerance kSame = {1e-6, false};

odo_barometer pressure(double t_s) {
  auto baro = pressure_at(MeasuredWalk::ns(t_s), 101000 - 12 * (0.02 * t_s + 0.1 * std::sin(t_s)));
  return baro;
}

odo_scale scale_at(double t_s) {
  auto event = make_message<odo_scale>(ODO_TYPE_SCALE, MeasuredWalk::ns(t_s));
  event.valid_from_ns = MeasuredWalk::ns(t_s - 1), event.valid_to_ns = MeasuredWalk::ns(t_s + 1);
  event.scale = 1.9 + 0.02 * std::sin(3 * t_s), event.sigma = 0.1, event.displacement_m = 1;
  return event;
}

/// Cycles through all parts of a fix.
void all_fixes(double t_s, odo_fix& fix) {
  const int kind = static_cast<int>(t_s / 2) % 4;
  if (kind == 1) fix.header.flags |= ODO_FIX_DOWN | ODO_FIX_COVARIANCE, fix.p_n[2] = -1.2, fix.covariance_n[8] = 0.3;
  if (kind == 2) fix.header.flags = ODO_FIX_YAW, fix.yaw_axis_b[1] = 1, fix.yaw_rad = 0.3, fix.yaw_sigma_rad = 0.2;
  if (kind == 3) {
    fix.header.flags |= ODO_FIX_ORIENTATION | ODO_FIX_ORIENTATION_COVARIANCE;
    fix.q_n_b[0] = std::cos(0.1), fix.q_n_b[3] = std::sin(0.1);
    for (const int i : {0, 4, 8}) fix.orientation_cov_n[i] = 0.05 + 0.01 * i;
  }
}

/// A walk with every kind of input: a tilted mount, fixes, a compass, blind frames, a new scale group, gaps.
WalkMeasurements measurements() {
  WalkMeasurements w{
      .q_b_c = Eigen::Quaterniond(0.3, 0.8, 0.4, -0.2).normalized(), .fix_every_s = 2, .change_fix = all_fixes};
  w.compass_sigma_rad = 0.1, w.compass_rad = [](double t) { return 0.1 * std::sin(t); };
  w.odometry.blind_from_s = 6, w.odometry.blind_to_s = 9;
  w.odometry.off_from_s = 11, w.odometry.off_to_s = 12;
  w.no_imu_from_s = 13, w.no_imu_to_s = 13.6;
  w.change = [](double t, odo_vo_motion& m) {
    if (t < 15) return;
    m.scale_group += 1;
    for (double& x : m.p_c0_c1) x *= 2;
  };
  return w;
}

StartPose start() {
  StartPose s;
  s.given = s.heading_given = true, s.position_m = {3, -2, 1}, s.heading_rad = 0.4;
  return s;
}

void add_held(Digest& digest, const KeptPose& held) {
  digest.add("held.p_n_b", held.p_n_b.data(), 3);
  digest.add("held.q_n_b", held.q_n_b.coeffs().data(), 4);
  digest.add_blocks("held.own", held.own.data(), 6);
  digest.add_blocks("held.cross", held.cross.data(), 6);
}

void add_estimate(Digest& digest, const Estimate& x) {
  digest.add("at.q_n_b", x.q_n_b.coeffs().data(), 4);
  digest.add("at.p_n_b", x.p_n_b.data(), 3);
  digest.add("at.v_n_b", x.v_n_b.data(), 3);
  digest.add("at.gyro_bias_b", x.gyro_bias_b.data(), 3);
  digest.add("at.accel_bias_b", x.accel_bias_b.data(), 3);
  digest.add("at.mean", x.velocity != Velocity::now);
}

std::string digest_of(const CouplingConfig& config) {
  MeasuredWalk walk(walk_scenario(24), measurements(), 5);
  TestFusion fusion(config, start(), {.vo = true, .scale = false});
  Digest digest;
  std::vector<uint64_t> held;
  double next_held_s = 3;
  walk.run(
      fusion,
      [&](double t, const odo_pose& pose) {
        digest.add("pose.p_n", pose.p_n, 3);
        digest.add("pose.q_n", pose.q_n, 4);
        digest.add("pose.velocity_n", pose.velocity_n, 3);
        digest.add_blocks("pose.covariance", pose.covariance, 6);
        digest.add_blocks("pose.velocity_covariance", pose.velocity_covariance, 3);
        digest.add("pose.scale", pose.scale);
        digest.add("pose.scale_sigma", pose.scale_sigma);
        digest.add("pose.distance_m", pose.distance_m);
        digest.add("pose.flags", pose.header.flags);
        digest.add("pose.state", pose.state * 100 + pose.reason);
        for (const double ahead_s : {-0.15, 0.0, 0.04}) {
          Estimate there;
          if (fusion.at(MeasuredWalk::ns(t + ahead_s), there) == ODO_OK) add_estimate(digest, there);
        }
        odo_fix reference;
        if (fusion.take_step_reference(reference))
          digest.add("reference.p_n", reference.p_n, 3),
              digest.add_blocks("reference.covariance_n", reference.covariance_n, 3);
        const ScaleKnowledge known = fusion->scale_knowledge();
        digest.add("scale.sigma", known.sigma);
        digest.add("scale.by_inertia", known.by_inertia);
        digest.add("scale.by_steps", known.by_steps);
        digest.add("placed", fusion->is_placed());
        if (t > next_held_s && held.size() < 4)
          held.push_back(fusion->keep_pose(MeasuredWalk::ns(t - 0.2)).pose_id), next_held_s += 2;
        const odo_barometer baro = pressure(t);
        fusion.update(&baro);
        const odo_scale scale = scale_at(t);
        fusion.update(&scale);
      },
      [&](const Correction& correction, const odo_pose&) {
        digest.add("correction.p", correction.p.data(), 3);
        digest.add("correction.q", correction.q.coeffs().data(), 4);
        digest.add("correction.reason", correction.reason);
      });
  KeptPose pose;
  for (const uint64_t id : held)
    if (fusion->kept_pose(id, pose)) add_held(digest, pose);
  if (fusion->pose_now(pose)) digest.add_blocks("now.covariance", pose.now.data(), 6);
  return digest.text();
}

}  // namespace

TEST_SUITE_BEGIN("kept_estimates");

TEST_CASE("the localizer and the papers' rules give the kept estimates with every kind of input") {
  if (!kept_for_this_machine()) return;
  CouplingConfig config;
  compare_kept("estimate_paper", digest_of(config), kSame);
  config.type = CouplingType::localizer;
  compare_kept("estimate_localizer", digest_of(config), kSame);
}
