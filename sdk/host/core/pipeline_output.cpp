// SPDX-License-Identifier: Apache-2.0
//
// What leaves the pipeline: poses, corrections and the state, to the listener and to the pose stream.
#include <algorithm>
#include <cmath>

#include <odograph/terrain.h>

#include "sdk/math/rotation.hpp"
#include "sdk/host/core/pipeline.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr Pipeline::Parameters kParameters;

/// The part of a rotation that is about the vertical (swing-twist decomposition).
Quaterniond about_down(const Quaterniond& q) {
  const double norm = std::hypot(q.w(), q.z());
  return norm > 0 ? Quaterniond(q.w() / norm, 0, 0, q.z() / norm) : Quaterniond::Identity();
}

}  // namespace

/// All that the localizer has to say, in order of time: a correction and the pose that it moved before newer poses.
void Pipeline::publish_estimates() {
  Correction correction;
  odo_pose corrected{}, pose{};
  const bool moved = composer_.take_correction(correction, corrected);
  if (moved) publish_correction(correction, corrected);
  bool any = composer_.take_pose(pose);
  if (moved && !(any && pose.header.t_ns == corrected.header.t_ns)) publish_pose(corrected, false);
  for (; any; any = composer_.take_pose(pose)) publish_pose(pose, true);
}

void Pipeline::publish_pose(odo_pose pose, bool is_new) {
  if (roster_.any_dead() && pose.state == ODO_TRACKING)
    pose.state = ODO_DEGRADED, pose.reason = ODO_REASON_PLUGIN_FAILED;
  if (sensor_silent()) pose.state = std::max(pose.state, ODO_DEGRADED), pose.reason = ODO_REASON_SENSOR_SILENT;
  if (north_is_true_ && pose.covariance[14] < kParameters.north_sigma_rad * kParameters.north_sigma_rad)
    pose.header.flags |= ODO_POSE_NORTH;
  if (before_restart_ && (pose.header.flags & ODO_POSE_POSITION)) publish_restart(pose);
  last_pose_ = pose;
  last_pose_ns_ = pose.header.t_ns;
  if (is_new) set_state(pose.header.t_ns, pose.state, pose.reason);
  {
    const std::lock_guard lock(world_mutex_);
    tell_stream(pose);
    anchors_.follow(composer_, pose.header.t_ns, nullptr);
  }
  publish_(pose.header);
  if (is_new && gives_poses_to_) enqueue(AnyMessage(pose.header));
}

void Pipeline::publish_correction(const Correction& correction, const odo_pose& corrected) {
  const Vector3d after(corrected.p_n), before = correction.q.conjugate() * (after - correction.p);
  const Quaterniond q = about_down(correction.q);
  const Vector3d p = after - q * before;
  correct_world(correction.t_ns, {q, p});
  auto event = make_message<odo_correction>(ODO_TYPE_CORRECTION, correction.t_ns);
  put_quaternion(q, event.q_n);
  Vector3d::Map(event.p_n) = p;
  event.reason = correction.reason;
  publish_(event.header);
  if (gives_corrections_to_) enqueue(AnyMessage(event.header));
}

/// The phone is where it was; n is another.
void Pipeline::publish_restart(const odo_pose& pose) {
  const odo_pose before = *std::exchange(before_restart_, std::nullopt);
  const Quaterniond q = about_down(quaternion(pose.q_n) * quaternion(before.q_n).conjugate());
  auto event = make_message<odo_correction>(ODO_TYPE_CORRECTION, pose.header.t_ns);
  event.q_n[0] = q.w(), event.q_n[3] = q.z();
  Vector3d::Map(event.p_n) = Vector3d(pose.p_n) - q * Vector3d(before.p_n);
  event.reason = ODO_CORRECTION_RESTART;
  const Rigid correction{q, Vector3d(event.p_n)};
  {
    const std::lock_guard lock(world_mutex_);
    anchors_.follow(composer_, pose.header.t_ns, &correction);
  }
  publish_(event.header);
  if (gives_corrections_to_) enqueue(AnyMessage(event.header));
}

/// Nobody sees a corrected phone among anchors that are not, nor the other way round.
void Pipeline::correct_world(int64_t t_ns, const Rigid& correction) {
  const std::lock_guard lock(world_mutex_);
  poses_.predictor().correct(correction.q, correction.p);
  anchors_.follow(composer_, t_ns, &correction);
}

/// What the first plugin with a terrain model says; nothing without one.
std::optional<double> Pipeline::ground_at(double north_m, double east_m, double near_down_m) const {
  for (const auto& plugin : roster_.plugins()) {
    const auto* terrain = static_cast<const odo_terrain*>(plugin->extension(ODO_EXTENSION_TERRAIN));
    double down_m = 0, sigma_m = 0;
    if (terrain && ODO_HAS(terrain, height) && terrain->height &&
        terrain->height(terrain->user, north_m, east_m, near_down_m, &down_m, &sigma_m) == ODO_OK &&
        std::isfinite(down_m))
      return down_m;
  }
  return std::nullopt;
}

/// The pose, and the state of the body that it is carried on from.
void Pipeline::tell_stream(const odo_pose& pose) {
  PosePredictor::Base base{pose, quaternion(pose.q_n), Vector3d(pose.p_n), {}};
  if (Estimate then; composer_.at(pose.header.t_ns, then) == ODO_OK) {
    base.q_n_b = then.q_n_b, base.p_n_b = then.p_n_b;
    if ((pose.header.flags & ODO_POSE_VELOCITY) && !then.velocity_is_mean) base.v_n_b = then.v_n_b;
    if (!then.gyro_bias_b.isZero()) {
      poses_.predictor().set_biases(then.gyro_bias_b, then.accel_bias_b);
      camera_knows_bias_ = true;
    }
  }
  poses_.add_pose(pose, base);
}

bool Pipeline::sensor_silent() const {
  return (watch_.imu_silent() && roster_.has_attitude()) || (watch_.camera_silent() && roster_.has_front_end());
}

/// Between two poses nobody else would notice. As long as the other sensor gives poses it is not lost.
void Pipeline::watch_silence() {
  if (!sensor_silent()) return;
  set_state(watch_.now_ns(), watch_.recent(last_pose_ns_) ? ODO_DEGRADED : ODO_LOST, ODO_REASON_SENSOR_SILENT);
}

void Pipeline::set_state(int64_t t_ns, uint32_t state, uint32_t reason) {
  state = std::min(state, ODO_LOST);
  if (state_ != 0 && t_ns > state_since_ns_) {
    counters_.state_s[state_] += static_cast<double>(t_ns - state_since_ns_) * kNanoseconds;
    state_since_ns_ = t_ns;
  }
  if (state == state_ && reason == reason_) return;
  if (state_ == 0) state_since_ns_ = t_ns;
  state_ = state;
  reason_ = reason;
  poses_.predictor().set_state(state, reason);
  auto event = make_message<odo_state>(ODO_TYPE_STATE, t_ns);
  event.state = state;
  event.reason = reason;
  publish_(event.header);
}

void Pipeline::wake() {
  if (!host_.has_woken()) return;
  events_.begin();
  roster_.wake([this] { handle_events(); });
}

}  // namespace odograph
