// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/pose_publisher.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/rotation.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr PosePublisher::Parameters kPublisher;

/// The rotation's component about the vertical (swing-twist decomposition).
Quaterniond about_down(const Quaterniond& q) {
  const double norm = std::hypot(q.w(), q.z());
  return norm > 0 ? Quaterniond(q.w() / norm, 0, 0, q.z() / norm) : Quaterniond::Identity();
}

/// Final check: no non-finite number is published.
bool is_finite(const odo_pose& pose) {
  const auto finite = [](const double* values, size_t count) {
    return std::all_of(values, values + count, [](double x) { return std::isfinite(x); });
  };
  return finite(pose.q_n, 4) && finite(pose.p_n, 3) && finite(pose.velocity_n, 3) && finite(pose.covariance, 36) &&
         std::isfinite(pose.scale + pose.scale_sigma + pose.distance_m);
}

}  // namespace

bool PosePublisher::publish(Fusion& fusion, const Outputs& outputs) {
  if (const auto& correction = outputs.correction) {
    if (!is_finite(correction->pose)) return false;
    publish_correction(fusion, *correction);
    const bool again = !outputs.poses.empty() && outputs.poses[0].header.t_ns == correction->pose.header.t_ns;
    if (!again) publish_pose(fusion, correction->pose, false);
  }
  for (const odo_pose& pose : outputs.poses) {
    if (!is_finite(pose)) return false;
    publish_pose(fusion, pose, true);
  }
  return true;
}

void PosePublisher::publish_pose(Fusion& fusion, odo_pose pose, bool is_new) {
  if (s_.roster.any_failed() && pose.state == ODO_TRACKING)
    pose.state = ODO_DEGRADED, pose.reason = ODO_REASON_PLUGIN_FAILED;
  if (sensor_silent()) pose.state = std::max(pose.state, ODO_DEGRADED), pose.reason = ODO_REASON_SENSOR_SILENT;
  if (s_.checks.any()) pose.state = std::max(pose.state, ODO_DEGRADED), pose.reason = ODO_REASON_WRONG_INPUT;
  if (s_.north.is_true() && pose.covariance[14] < kPublisher.north_sigma_rad * kPublisher.north_sigma_rad)
    pose.header.flags |= ODO_POSE_NORTH;
  if (before_restart_ && (pose.header.flags & ODO_POSE_POSITION)) publish_restart(fusion, pose);
  last_ = pose;
  if (is_new) set_state(pose.header.t_ns, pose.state, pose.reason);
  {
    const std::lock_guard lock(s_.world_mutex);
    add_to_stream(fusion, pose);
    if (is_new) s_.scene.see(pose);
    s_.anchors.update(fusion, pose.header.t_ns, nullptr);
  }
  publish_(pose.header);
  if (is_new) notify_plugins_(pose.header);
}

void PosePublisher::publish_correction(Fusion& fusion, const Correction& correction) {
  const int64_t t_ns = correction.pose.header.t_ns;
  const Vector3d after(correction.pose.p_n), before = correction.q.conjugate() * (after - correction.p);
  const Quaterniond q = about_down(correction.q);
  const Rigid level{q, after - q * before};
  {  // readers must never combine a corrected phone with uncorrected anchors, or vice versa
    const std::lock_guard lock(s_.world_mutex);
    s_.poses.correct(level);
    s_.scene.correct(level);
    s_.anchors.update(fusion, t_ns, &level);
  }
  announce(t_ns, level, correction.reason);
}

/// The phone has not moved; n has changed.
void PosePublisher::publish_restart(Fusion& fusion, const odo_pose& pose) {
  const odo_pose before = *std::exchange(before_restart_, std::nullopt);
  const Quaterniond q = about_down(quaternion(pose.q_n) * quaternion(before.q_n).conjugate());
  const Rigid correction{q, Vector3d(pose.p_n) - q * Vector3d(before.p_n)};
  {
    const std::lock_guard lock(s_.world_mutex);
    s_.scene.correct(correction);
    s_.anchors.update(fusion, pose.header.t_ns, &correction);
  }
  announce(pose.header.t_ns, correction, ODO_CORRECTION_RESTART);
}

void PosePublisher::announce(int64_t t_ns, const Rigid& correction, uint32_t reason) {
  auto event = make_message<odo_correction>(ODO_TYPE_CORRECTION, t_ns);
  put_quaternion(correction.q, event.q_n);
  Vector3d::Map(event.p_n) = correction.p;
  event.reason = reason;
  publish_(event.header);
  notify_plugins_(event.header);
}

/// Adds the pose and the body state for prediction.
void PosePublisher::add_to_stream(const Fusion& fusion, const odo_pose& pose) {
  PosePredictor::Base base{pose, quaternion(pose.q_n), Vector3d(pose.p_n), {}, {}};
  if (Estimate then; fusion.at(pose.header.t_ns, then) == ODO_OK) {
    base.q_n_b = then.q_n_b, base.p_n_b = then.p_n_b;
    if ((pose.header.flags & ODO_POSE_VELOCITY) && then.velocity == Velocity::now) base.v_n_b = then.v_n_b;
    if ((pose.header.flags & ODO_POSE_VELOCITY) && then.velocity == Velocity::steps)
      base.walks_until_ns = then.velocity_until_ns;
    if (!then.gyro_bias_b.isZero()) base.biases = {then.gyro_bias_b, then.accel_bias_b};
  }
  s_.poses.add_pose(pose, base);
}

bool PosePublisher::sensor_silent() const {
  return (s_.watch.imu_silent() && s_.roster.has_attitude()) || (s_.watch.camera_silent() && s_.roster.has_front_end());
}

void PosePublisher::pause() {
  const SensorWatch::Pause& pause = s_.watch.pause();
  set_state(pause.from_ns, state_, reason_);
  if (state_ != 0) set_state(pause.from_ns, ODO_LOST, ODO_REASON_SENSOR_SILENT);
  set_state(pause.to_ns, state_, reason_);
}

/// A plugin that is down may yield no pose that could state it. Neither a silent sensor nor a wrong one means a lost
/// track while another one yields poses.
void PosePublisher::check_input() {
  if (state_ == ODO_TRACKING && s_.roster.any_failed())
    set_state(s_.watch.now_ns(), ODO_DEGRADED, ODO_REASON_PLUGIN_FAILED);
  if (!s_.checks.any() && !sensor_silent()) return;
  const bool poses = last_ && s_.watch.recent(last_->header.t_ns);
  set_state(s_.watch.now_ns(), poses ? ODO_DEGRADED : ODO_LOST,
            s_.checks.any() ? ODO_REASON_WRONG_INPUT : ODO_REASON_SENSOR_SILENT);
}

void PosePublisher::set_state(int64_t t_ns, uint32_t state, uint32_t reason) {
  state = std::min(state, ODO_LOST);
  if (state_ != 0 && t_ns > state_since_ns_) {
    state_s_[state_] += static_cast<double>(t_ns - state_since_ns_) * kNanoseconds;
    state_since_ns_ = t_ns;
  }
  if (state == state_ && reason == reason_) return;
  if (state_ == 0) state_since_ns_ = t_ns;
  state_ = state;
  reason_ = reason;
  s_.poses.set_state(state, reason);
  auto event = make_message<odo_state>(ODO_TYPE_STATE, t_ns);
  event.state = state;
  event.reason = reason;
  publish_(event.header);
}

void PosePublisher::reset() {
  if (last_) before_restart_ = std::exchange(last_, std::nullopt);
  state_ = 0;
}

}  // namespace odograph
