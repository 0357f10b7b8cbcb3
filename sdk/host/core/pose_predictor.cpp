// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/pose_predictor.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/host/base/saturating.hpp"
#include "sdk/host/fusion/outputs.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

bool is_camera(const odo_pose& pose) { return (pose.header.flags & ODO_POSE_CAMERA) != 0; }

}  // namespace

PosePredictor::PosePredictor(const Parameters& parameters, const SmoothPose::Parameters& smooth)
    : parameters_(parameters), blend_(smooth), smooth_(smooth) {
  clear();
}

void PosePredictor::clear() {
  track_.clear();
  base_ = {};
  base_.pose.header.t_ns = published_ns_ = queried_ns_ = INT64_MIN;
  velocity_ = Velocity::none;
  v_n_b_.setZero(), rate_b_.setZero(), p_b_c_.setZero(), force_n_.setZero();
  q_b_c_.setIdentity(), q_align_.setIdentity();
  base_point_.reset();
  attitude_ = {};
  has_pose_bias_ = false;
  fit_samples_.clear();
  state_ = ODO_LOST, reason_ = ODO_REASON_INITIALISING;
  blend_.reset();
  smooth_.reset();
}

void PosePredictor::add_attitude(const odo_attitude& attitude) {
  if (!has_pose_bias_ && (attitude.header.flags & ODO_ATTITUDE_GYRO_BIAS))
    track_.set_biases(Vector3d(attitude.gyro_bias_b), Vector3d::Zero());
  if (attitude.header.t_ns <= attitude_.t_ns) return;
  attitude_ = {attitude.header.t_ns, quaternion(attitude.q_n_b)};
}

void PosePredictor::correct(const Rigid& correction) {
  const Quaterniond& q = correction.q;
  const int64_t then_ns = std::max(newest_ns(), queried_ns_);
  if (has_pose()) blend_.correct(then_ns, correction, smooth_.at(then_ns, pose_of(body_at(then_ns))));
  smooth_.rotate(q);
  for (size_t i = 0; i < fit_samples_.size(); ++i)
    fit_samples_.back(i).p_n_b = q * fit_samples_.back(i).p_n_b + correction.p;
  base_.q_n_b = q * base_.q_n_b;
  base_.p_n_b = q * base_.p_n_b + correction.p;
  v_n_b_ = q * v_n_b_;
  force_n_ = q * force_n_;
  q_align_ = q * q_align_;
}

void PosePredictor::add_pose(int64_t published_ns, const Base& base) {
  published_ns_ = published_ns;
  if (base.biases) track_.set_biases(base.biases->gyro_b, base.biases->accel_b), has_pose_bias_ = true;
  const int64_t t_ns = base.pose.header.t_ns, then_ns = std::max({newest_ns(), t_ns, queried_ns_});
  const bool begins = !has_pose() || is_camera(base_.pose) != is_camera(base.pose);
  const bool had_position = !begins && position_known(then_ns);
  const auto before = begins ? SmoothPose::Pose{} : pose_of(body_at(then_ns));
  const double dt = begins ? 0.0 : seconds(t_ns, base_.pose.header.t_ns);
  if (dt > 0) rate_b_ = dt < 0.2 ? Vector3d(log_rotation(base_.q_n_b.conjugate() * base.q_n_b) / dt) : Vector3d::Zero();
  if (begins) fit_samples_.clear();
  std::optional<Vector3d> predicted;
  if (!begins && velocity_ == Velocity::now) {
    const Body body = body_at(t_ns);
    const Vector3d jump = base.p_n_b - body.p_n_b;
    const bool jumped = jump.norm() > parameters_.jump_m;  // an unannounced jump: move the stored data along
    for (size_t i = 0; i < fit_samples_.size() && jumped; ++i) fit_samples_.back(i).p_n_b += jump;
    if (!jumped && dt > 0) predicted = body.v_n_b;
  }

  base_ = base;
  q_b_c_ = base.q_n_b.conjugate() * quaternion(base.pose.q_n);
  p_b_c_ = base.q_n_b.conjugate() * (Vector3d(base.pose.p_n) - base.p_n_b);
  base_point_ = track_.at(t_ns, parameters_.ahead_s);
  if (base_point_ && base_point_->t_ns != t_ns) base_point_.reset();  // the samples end long before
  align_attitude();
  choose_velocity(predicted);

  if (begins) return smooth_.reset();
  const auto after = pose_of(body_at(then_ns));
  smooth_.jumped(then_ns, {before.q_n, had_position ? before.p_n : after.p_n}, after);
}

/// The attitude's heading origin is arbitrary; align it where a camera determines the orientation.
void PosePredictor::align_attitude() {
  if (attitude_.t_ns == INT64_MIN) return;
  const auto point = track_.at(attitude_.t_ns, parameters_.ahead_s);
  Quaterniond q = attitude_.q_n_b;
  if (point && base_point_) q = q * point->q_e_b.conjugate() * base_point_->q_e_b;
  q_align_ = (base_.q_n_b * q.conjugate()).normalized();
}

/// `predicted`: velocity predicted from the previous pose.
void PosePredictor::choose_velocity(const std::optional<Vector3d>& predicted) {
  const odo_pose& pose = base_.pose;
  const int64_t t_ns = pose.header.t_ns;
  velocity_ = Velocity::none;
  v_n_b_.setZero();
  const bool metric = (pose.header.flags & ODO_POSE_METRIC) != 0 && (pose.header.flags & ODO_POSE_POSITION) != 0;
  const bool inertial = base_point_ && track_.has_force();
  if (!metric || !inertial || base_.walks_until_ns) {
    fit_samples_.clear();
  } else if (!fit_samples_.empty() && fit_samples_.back(0).t_ns == t_ns) {
    fit_samples_.back(0).p_n_b = base_.p_n_b;  // corrected
  } else {
    fit_samples_.push({t_ns, base_.p_n_b, *base_point_});
  }
  if (base_.walks_until_ns) {
    velocity_ = Velocity::mean;
    v_n_b_ = Vector3d(pose.velocity_n);
  } else if (inertial && metric && base_.v_n_b) {
    velocity_ = Velocity::now;
    v_n_b_ = *base_.v_n_b;
    force_n_.setZero();
    planar_ = false;
  } else if (is_camera(pose) && fit_velocity()) {
    velocity_ = Velocity::now;
    if (!predicted) return;
    force_n_ += (v_n_b_ - *predicted) / parameters_.force_tau_s;
    if (const double norm = force_n_.norm(); norm > parameters_.largest_force_mps2)
      force_n_ *= parameters_.largest_force_mps2 / norm;
  } else if (pose.header.flags & ODO_POSE_VELOCITY) {
    velocity_ = Velocity::mean;
    Vector3d rate_b;
    const Quaterniond q_n_b = orientation_at(t_ns, rate_b);
    v_n_b_ = Vector3d(pose.velocity_n) - q_n_b * rate_b.cross(p_b_c_);
  }
}

/// Least-squares velocity over the newest poses: p_i - (displacement by force and gravity between t_i and now) = p + v
/// (t_i - now). False if there are too few.
bool PosePredictor::fit_velocity() {
  if (!base_point_) return false;
  const Quaterniond q_n_e = base_.q_n_b * base_point_->q_e_b.conjugate();
  const Vector3d constant_n = Vector3d(0, 0, parameters_.gravity_mps2) + force_n_;
  double n = 0, sum_t = 0, sum_tt = 0, height_m = 0;
  Vector3d sum_y = Vector3d::Zero(), sum_ty = Vector3d::Zero();
  for (size_t i = 0; i < fit_samples_.size(); ++i) {
    const FitSample& s = fit_samples_.back(i);
    const double t = seconds(s.t_ns, base_.pose.header.t_ns);
    if (-t > parameters_.velocity_window_s) break;
    const Vector3d moved_e = s.point.p_e - base_point_->p_e - t * base_point_->v_e;
    const Vector3d y = s.p_n_b - q_n_e * moved_e - 0.5 * t * t * constant_n;
    n += 1, sum_t += t, sum_tt += t * t, sum_y += y, sum_ty += t * y;
    height_m = std::max(height_m, std::abs(s.p_n_b.z() - base_.p_n_b.z()));
  }
  const double spread = n * sum_tt - sum_t * sum_t;
  if (n < static_cast<double>(parameters_.velocity_poses) || spread <= 0) return false;
  v_n_b_ = (n * sum_ty - sum_t * sum_y) / spread;
  planar_ = height_m < parameters_.planar_m;
  if (planar_) v_n_b_.z() = 0;
  return true;
}

int64_t PosePredictor::newest_ns() const {
  return std::max({base_.pose.header.t_ns, track_.newest_ns(), attitude_.t_ns});
}

/// A walker at rest yields no poses; the position remains at the end of the last step.
bool PosePredictor::position_known(int64_t t_ns) const {
  if (!has_pose() || (base_.pose.header.flags & ODO_POSE_POSITION) == 0) return false;
  if (!is_camera(base_.pose)) return true;
  const bool recent = seconds(t_ns, base_.pose.header.t_ns) <= parameters_.position_for_s;
  return state_ != ODO_LOST && (recent || base_.walks_until_ns);
}

Quaterniond PosePredictor::orientation_at(int64_t t_ns, Vector3d& rate_b) const {
  const int64_t pose_ns = base_.pose.header.t_ns;
  const double after_s = has_pose() && is_camera(base_.pose) ? parameters_.attitude_after_s : 0.0;
  const bool by_attitude = attitude_.t_ns != INT64_MIN && (!has_pose() || seconds(attitude_.t_ns, pose_ns) > after_s);
  const int64_t from_ns = by_attitude ? attitude_.t_ns : pose_ns;
  const Quaterniond from = by_attitude ? q_align_ * attitude_.q_n_b : base_.q_n_b;
  const auto point = by_attitude ? track_.at(from_ns, parameters_.ahead_s) : base_point_;
  const auto now = track_.at(t_ns, parameters_.ahead_s);
  if (point && now) {
    rate_b = now->rate_b;
    return (from * point->q_e_b.conjugate() * now->q_e_b).normalized();
  }
  rate_b = by_attitude ? Vector3d::Zero() : rate_b_;
  const double dt = std::clamp(seconds(t_ns, from_ns), -parameters_.ahead_s, parameters_.ahead_s);
  return (from * exp_rotation(dt * rate_b)).normalized();
}

PosePredictor::Body PosePredictor::body_at(int64_t t_ns) const {
  Body body;
  body.q_n_b = orientation_at(t_ns, body.rate_b);
  if (!has_pose()) return body;
  const int64_t pose_ns = base_.pose.header.t_ns;
  body.p_n_b = base_.p_n_b;
  body.v_n_b = v_n_b_;
  if (base_.walks_until_ns) return walk_on(t_ns, body), body;
  int64_t until_ns = pose_ns;
  const auto now = velocity_ == Velocity::now ? track_.at(t_ns, parameters_.ahead_s) : std::nullopt;
  if (now && base_point_) {
    const Quaterniond q_n_e = base_.q_n_b * base_point_->q_e_b.conjugate();
    const Vector3d constant_n = Vector3d(0, 0, parameters_.gravity_mps2) + force_n_;
    const double dt = seconds(now->t_ns, pose_ns);
    Vector3d moved_n = q_n_e * (now->p_e - base_point_->p_e - dt * base_point_->v_e) + 0.5 * dt * dt * constant_n;
    Vector3d gained_n = q_n_e * (now->v_e - base_point_->v_e) + dt * constant_n;
    if (planar_) moved_n.z() = gained_n.z() = 0;
    body.p_n_b += dt * v_n_b_ + moved_n;
    body.v_n_b += gained_n;
    until_ns = now->t_ns;
  }
  body.p_n_b +=
      std::clamp(seconds(t_ns, until_ns), -parameters_.position_for_s, parameters_.position_for_s) * body.v_n_b;
  return body;
}

void PosePredictor::walk_on(int64_t t_ns, Body& body) const {
  const double due_s = seconds(*base_.walks_until_ns, base_.pose.header.t_ns),
               since_s = seconds(t_ns, base_.pose.header.t_ns);
  body.p_n_b.head<2>() += walked_on_s(since_s, due_s) * v_n_b_.head<2>();
  if (since_s > due_s) body.v_n_b.setZero();
}

SmoothPose::Pose PosePredictor::pose_of(const Body& body) const {
  return {body.q_n_b * q_b_c_, body.p_n_b + body.q_n_b * p_b_c_};
}

SmoothPose::Pose PosePredictor::smoothed(int64_t t_ns, const SmoothPose::Pose& pose) const {
  return blend_.at(t_ns, smooth_.at(t_ns, pose));
}

Rigid PosePredictor::smooth_pose(const odo_pose& published) const {
  const auto smooth = smoothed(published.header.t_ns, {quaternion(published.q_n), Vector3d(published.p_n)});
  return {smooth.q_n, smooth.p_n};
}

int32_t PosePredictor::at(int64_t t_ns, bool smooth, odo_pose& out) const {
  if (!has_pose() && attitude_.t_ns == INT64_MIN) return ODO_NOT_READY;
  if (t_ns == INT64_MIN) t_ns = newest_ns();
  if (seconds(t_ns, newest_ns()) > parameters_.longest_s) return ODO_E_NOT_FOUND;
  const Body body = body_at(t_ns);
  SmoothPose::Pose pose = pose_of(body);
  if (smooth) {
    pose = smoothed(t_ns, pose);
    queried_ns_ = std::max(queried_ns_, t_ns);
  }

  out = base_.pose;
  out.header.struct_size = sizeof out;
  out.header.type = ODO_TYPE_POSE;
  out.header.t_ns = t_ns;
  out.header.flags &= ~(ODO_POSE_POSITION | ODO_POSE_METRIC | ODO_POSE_VELOCITY);
  out.header.flags |= ODO_POSE_ORIENTATION;
  if (t_ns != published_ns_) out.header.flags |= ODO_POSE_EXTRAPOLATED;
  put_quaternion(pose.q_n, out.q_n);
  out.header.flags &= ~ODO_POSE_ANGULAR_VELOCITY;
  if (track_.at(t_ns, parameters_.ahead_s)) {
    out.header.flags |= ODO_POSE_ANGULAR_VELOCITY;
    Vector3d::Map(out.angular_velocity) = q_b_c_.conjugate() * body.rate_b;
  }
  out.state = state_, out.reason = reason_;
  if (!position_known(t_ns)) {
    if (state_ == ODO_TRACKING) out.state = ODO_LOST, out.reason = ODO_REASON_SENSOR_SILENT;
    return ODO_OK;
  }
  out.header.flags |= base_.pose.header.flags & (ODO_POSE_POSITION | ODO_POSE_METRIC);
  Vector3d::Map(out.p_n) = pose.p_n;
  const bool steps = base_.walks_until_ns.has_value(), stands = steps && t_ns > *base_.walks_until_ns;
  const bool known = velocity_ != Velocity::none && !stands;
  if (known) {
    out.header.flags |= ODO_POSE_VELOCITY;
    Vector3d::Map(out.velocity_n) = body.v_n_b;
    if (!steps) Vector3d::Map(out.velocity_n) += body.q_n_b * body.rate_b.cross(p_b_c_);
  }
  const double known_sigma = steps ? parameters_.walking_sigma_mps : parameters_.velocity_sigma_mps;
  const double sigma = known ? known_sigma : parameters_.unknown_sigma_mps;
  const double since_s = std::max(0.0, seconds(t_ns, base_.pose.header.t_ns));
  const double moved_m =
      sigma * (is_camera(base_.pose) && !steps ? since_s : std::min(since_s, parameters_.step_delay_s));
  for (const int i : {21, 28, 35}) out.covariance[i] += moved_m * moved_m;
  return ODO_OK;
}

}  // namespace odograph
