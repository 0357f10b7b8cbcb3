// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "sdk/math/rotation.hpp"
#include "tests/support/test_fusion.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/walker.hpp"

namespace odograph {

/// Measurements of a simulated walk without pictures: a localizer's input, made from the truth plus noise of known
/// size, to test its consistency.
struct WalkMeasurements {
  struct Odometry {
    double rate_hz = 10;
    double inverse_scale = 2.5;  ///< 1 with scale_sigma above 0: a metric front-end with a scale error of that sigma
    double scale_sigma = 0;
    double position_m = 0.02;  ///< relative to the map, white over correlation_s
    double correlation_s = 0.25;
    double rotation_rad = 0.003;
    double rotation_walk = 5e-4;  ///< rad/sqrt(s)
    double drift_per_root_m = 0.01;
    double scale_walk = 2e-3;      ///< 1/sqrt(m)
    double stated_covariance = 1;  ///< factor on the reported covariance
    double blind_from_s = 1e9, blind_to_s = 1e9;
    double from_s = 0;
    double off_from_s = 1e9, off_to_s = 1e9;  ///< without frames
  } odometry;
  double no_imu_from_s = 1e9, no_imu_to_s = 1e9;
  bool steps = true, camera = true, attitude = true;
  Eigen::Quaterniond q_b_c{0, 1, 0, 0};  ///< the camera's mount: a phone's rear camera
  double step_factor_sigma = 0.08, step_own = 0.05, step_heading_rad = 0.05, step_offset_rad = 0.1;
  double fix_every_s = 0, fix_sigma_m = 1.0, fix_late_s = 0.3;
  double start_s = 0, end_s = 1e9;
  double first_tilt_rad = 0;                      ///< about north, of the first reported attitude: a phone in free fall
  double compass_sigma_rad = 0;                   ///< above 0: attitudes have north as well,
  std::function<double(double t_s)> compass_rad;  ///< with this error
  std::function<void(double t_s, odo_vo_motion& motion)> change;
  std::function<void(double t_s, odo_fix& fix)> change_fix;
  std::function<void(double t_s, odo_step& step)> change_step;
  std::function<int(double t_s)> step_times;  ///< number of reports of a step

  struct Truth {
    Eigen::Quaterniond q_n_c;
    Eigen::Vector3d p_n_c;
  };
};

/// A straight walk with a corner, as in `odograph sim`.
inline Scenario walk_scenario(double length_m) {
  Scenario s;
  s.route = {{0, 0, 0}, {0.5 * length_m, 0, 0}, {0.8 * length_m, 0.4 * length_m, 0}};
  return s;
}

class MeasuredWalk {
 public:
  MeasuredWalk(const Scenario& scenario, const WalkMeasurements& what, uint64_t seed)
      : w_(what), journey_(make_walk(scenario, seed)), random_(seed, 77), imu_random_(seed, 78) {
    for (double* b : {&gyro_bias_[0], &gyro_bias_[1], &gyro_bias_[2]}) *b = 0.005 * random_.normal();
    for (double* b : {&accel_bias_[0], &accel_bias_[1], &accel_bias_[2]}) *b = 0.05 * random_.normal();
    log_units_ = std::log(w_.odometry.inverse_scale) + w_.odometry.scale_sigma * random_.normal();
    log_factor_ = w_.step_factor_sigma * random_.normal();
    step_offset_ = w_.step_offset_rad * random_.normal();
    q_b_c_ = w_.q_b_c;
  }

  double duration_s() const { return std::min(w_.end_s, journey_.phone.duration_s()); }
  WalkMeasurements::Truth truth(double t_s) const {
    const auto T = journey_.phone.pose(t_s);
    return {Eigen::Quaterniond(T.linear()) * q_b_c_, T.translation() + T.linear() * p_b_c_};
  }
  static int64_t ns(double t_s) { return 1'000'000'000 + static_cast<int64_t>(std::llround(t_s * 1e9)); }
  const Eigen::Vector3d& p_b_c() const { return p_b_c_; }
  double log_factor() const { return log_factor_; }

  /// Runs it; `on_pose` receives every published pose, `on_correction` every announced jump.
  void run(TestFusion& fusion, const std::function<void(double t_s, const odo_pose&)>& on_pose,
           const std::function<void(const Correction&, const odo_pose&)>& on_correction = {}) {
    auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
    calibration.header.flags = ODO_CALIBRATION_EXTRINSICS;
    const Eigen::Quaterniond& q = q_b_c_;
    calibration.q_b_c[0] = q.w(), calibration.q_b_c[1] = q.x(), calibration.q_b_c[2] = q.y();
    calibration.q_b_c[3] = q.z();
    Eigen::Vector3d::Map(calibration.p_b_c) = p_b_c_;
    fusion->on_calibration(calibration);
    const double dt = 0.005;
    double next_frame = w_.start_s + 0.0123, next_fix = w_.start_s + w_.fix_every_s;
    size_t next_step = 0;
    std::vector<std::pair<double, odo_fix>> late;
    const auto drain = [&] {
      odo_pose pose;
      while (fusion.take_pose(pose)) on_pose(static_cast<double>(pose.header.t_ns - 1'000'000'000) * 1e-9, pose);
      Correction correction;
      if (fusion.take_correction(correction, pose) && on_correction) on_correction(correction, pose);
    };
    for (double t = w_.start_s; t < duration_s(); t += dt) {
      const auto state = journey_.phone.at(t);
      auto imu = make_message<odo_imu>(ODO_TYPE_IMU, ns(t));
      imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
      for (int i = 0; i < 3; ++i) {
        imu.gyro_b[i] = state.angular_velocity_b[i] + gyro_bias_[i] + 1e-3 / std::sqrt(dt) * imu_random_.normal();
        imu.accel_b[i] = state.specific_force_b()[i] + accel_bias_[i] + 2e-3 / std::sqrt(dt) * imu_random_.normal();
      }
      const bool no_imu = t >= w_.no_imu_from_s && t < w_.no_imu_to_s;
      if (!no_imu) fusion->on_imu(imu);
      if (w_.attitude && !no_imu) attitude(fusion, t, state);
      drain();
      while (w_.camera && next_frame < t + dt) {
        const bool off = next_frame >= w_.odometry.off_from_s && next_frame < w_.odometry.off_to_s;
        if (next_frame >= w_.odometry.from_s && !off) frame(fusion, next_frame);
        drain();
        next_frame += 1 / w_.odometry.rate_hz;
      }
      while (w_.steps && next_step < journey_.steps.size() && journey_.steps[next_step].t_end_s + 0.36 < t) {
        if (journey_.steps[next_step].t_start_s > w_.start_s) step(fusion, journey_.steps[next_step]);
        ++next_step;
        drain();
      }
      if (w_.fix_every_s > 0 && t >= next_fix) {
        late.emplace_back(t + w_.fix_late_s, fix(t));
        next_fix += w_.fix_every_s;
      }
      while (!late.empty() && late.front().first <= t) {
        fusion.update(&late.front().second);
        late.erase(late.begin());
        drain();
      }
    }
  }

 private:
  void attitude(TestFusion& fusion, double t, const Motion::State& state) {
    auto a = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, ns(t));
    if (!tilted_) {
      tilted_ = true;
      for (int i = 0; i < 2; ++i) tilt_[i] = 0.015 * random_.normal();
    }
    Eigen::Quaterniond q = exp_rotation(tilt_) * Eigen::Quaterniond(state.T_n_b.linear());
    if (!has_first_attitude_) q = exp_rotation(w_.first_tilt_rad * Eigen::Vector3d::UnitX()) * q;
    has_first_attitude_ = true;
    if (w_.compass_sigma_rad > 0) {
      a.header.flags |= ODO_ATTITUDE_MAGNETIC_NORTH;
      a.covariance_n[8] = w_.compass_sigma_rad * w_.compass_sigma_rad;
      q = exp_rotation(w_.compass_rad(t) * Eigen::Vector3d::UnitZ()) * q;
    }
    a.q_n_b[0] = q.w(), a.q_n_b[1] = q.x(), a.q_n_b[2] = q.y(), a.q_n_b[3] = q.z();
    a.covariance_n[0] = a.covariance_n[4] = 0.02 * 0.02;
    fusion.update(&a);
  }

  void frame(TestFusion& fusion, double t) {
    fusion.update(FrameTime{ns(t)});
    const auto true_pose = truth(t);
    const auto& o = w_.odometry;
    const double dt = last_frame_s_ < 0 ? 0 : t - last_frame_s_;
    // Pose of the odometry, with errors relative to its map and drift.
    const double keep = std::exp(-dt / std::max(1e-3, o.correlation_s)), fresh = std::sqrt(1 - keep * keep);
    for (int i = 0; i < 3; ++i) {
      error_m_[i] = last_frame_s_ < 0 ? o.position_m * random_.normal()
                                      : keep * error_m_[i] + fresh * o.position_m * random_.normal();
      error_rad_[i] = keep * error_rad_[i] + fresh * o.rotation_rad * random_.normal();
      turned_rad_[i] += o.rotation_walk * std::sqrt(dt) * random_.normal();
    }
    if (last_frame_s_ >= 0) {
      const Eigen::Vector3d d_n = true_pose.p_n_c - last_true_.p_n_c;
      const double length = d_n.norm();
      log_units_ += o.scale_walk * std::sqrt(length) * random_.normal();
      map_n_ += std::exp(log_units_) * (exp_rotation(turned_rad_) * d_n);
      for (int i = 0; i < 3; ++i)
        map_n_[i] += std::exp(log_units_) * o.drift_per_root_m * std::sqrt(length) * random_.normal();
    }
    const Eigen::Vector3d y_n = map_n_ + std::exp(log_units_) * error_m_;
    const Eigen::Quaterniond q_n = exp_rotation(turned_rad_ + error_rad_) * true_pose.q_n_c;
    const bool blind = t > o.blind_from_s && t < o.blind_to_s;
    if (last_frame_s_ >= 0) {
      auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, ns(t));
      m.t_from_ns = ns(last_frame_s_);
      m.state = blind ? ODO_LOST : ODO_TRACKING;
      if (blind) {
        ++group_after_;
      } else {
        m.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_COVARIANCE;
        const Eigen::Quaterniond dq = last_q_n_.conjugate() * q_n;
        m.q_c0_c1[0] = dq.w(), m.q_c0_c1[1] = dq.x(), m.q_c0_c1[2] = dq.y(), m.q_c0_c1[3] = dq.z();
        Eigen::Vector3d::Map(m.p_c0_c1) = last_q_n_.conjugate() * (y_n - last_y_n_);
        for (int i = 0; i < 6; ++i) m.covariance[7 * i] = 1e-6 * o.stated_covariance;
        if (o.scale_sigma > 0) {
          m.header.flags |= ODO_VO_METRIC | ODO_VO_INERTIAL;
          m.scale_sigma = o.scale_sigma;
          const auto phone = journey_.phone.at(t);
          const Eigen::Vector3d v_n =
              phone.velocity_n + phone.T_n_b.rotation() * phone.angular_velocity_b.cross(p_b_c_);
          Eigen::Vector3d::Map(m.velocity_c1) = std::exp(log_units_) * (true_pose.q_n_c.conjugate() * v_n);
          Eigen::Vector3d::Map(m.gravity_c1) = true_pose.q_n_c.conjugate() * Eigen::Vector3d::UnitZ();
        }
      }
      if (w_.change) w_.change(t, m);
      fusion->prepare(m);
      fusion.update(RelativeMotion{&m, nullptr});
    }
    last_frame_s_ = t, last_true_ = true_pose, last_y_n_ = y_n, last_q_n_ = q_n;
  }

  void step(TestFusion& fusion, const Journey::Step& true_step) {
    auto s = make_message<odo_step>(ODO_TYPE_STEP, ns(true_step.t_end_s + 0.36));
    s.header.flags = ODO_STEP_HEADING;
    s.t_start_ns = ns(true_step.t_start_s), s.t_end_ns = ns(true_step.t_end_s);
    const Eigen::Vector3d d =
        journey_.phone.pose(true_step.t_end_s).translation() - journey_.phone.pose(true_step.t_start_s).translation();
    const double length = d.head<2>().norm();
    s.length_m = std::exp(-log_factor_) * length * (1 + w_.step_own * random_.normal());
    s.sigma_m = s.length_m * std::hypot(w_.step_factor_sigma, w_.step_own);
    s.heading_rad = std::atan2(d.y(), d.x()) + step_offset_ + w_.step_heading_rad * random_.normal();
    s.frequency_hz = 1 / (true_step.t_end_s - true_step.t_start_s);
    s.mode = ODO_MODE_WALKING_TEXTING;
    if (w_.change_step) w_.change_step(true_step.t_end_s, s);
    const int times = w_.step_times ? w_.step_times(true_step.t_end_s) : 1;
    for (int i = 0; i < times && s.length_m > 0.05; ++i) fusion.update(&s);
  }

  odo_fix fix(double t) {
    auto f = make_message<odo_fix>(ODO_TYPE_FIX, ns(t));
    f.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
    const Eigen::Vector3d p = journey_.phone.pose(t).translation();
    for (int i = 0; i < 2; ++i) f.p_n[i] = p[i] + w_.fix_sigma_m * random_.normal();
    f.covariance_n[0] = f.covariance_n[4] = w_.fix_sigma_m * w_.fix_sigma_m;
    if (w_.change_fix) w_.change_fix(t, f);
    return f;
  }

  WalkMeasurements w_;
  Journey journey_;
  Random random_, imu_random_;
  double gyro_bias_[3], accel_bias_[3];
  Eigen::Quaterniond q_b_c_;
  Eigen::Vector3d p_b_c_{0.03, 0.06, -0.005};
  double log_units_, log_factor_, step_offset_;
  bool tilted_ = false, has_first_attitude_ = false;
  Eigen::Vector3d tilt_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d error_m_ = Eigen::Vector3d::Zero(), error_rad_ = Eigen::Vector3d::Zero(),
                  turned_rad_ = Eigen::Vector3d::Zero(), map_n_ = Eigen::Vector3d::Zero(),
                  last_y_n_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond last_q_n_ = Eigen::Quaterniond::Identity();
  WalkMeasurements::Truth last_true_{};
  double last_frame_s_ = -1;
  int group_after_ = 0;
};

}  // namespace odograph
