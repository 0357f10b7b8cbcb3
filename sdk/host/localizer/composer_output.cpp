// SPDX-License-Identifier: Apache-2.0
//
// Poses, corrections of them, and the metric displacement for step estimators.
#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/localizer/composer.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

template <class T>
bool take(std::optional<T>& from, T& out) {
  if (!from) return false;
  out = *std::exchange(from, std::nullopt);
  return true;
}

}  // namespace

void Composer::set_source(const MotionSource& source) {
  if (source.index() != source_.index()) notice_ = {"motion_source", describe(source)};
  source_ = source;
}

bool Composer::shows_metres() const {
  if (!paper()) return metric_;
  return !inputs_.vo || group_.metric || (inputs_.scale && localizer_.P(kLogScale, kLogScale) < 1 && metric_);
}

odo_pose Composer::make_pose(const TrackPoint& point) const {
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, point.t_ns);
  const bool placed = metric_ || paper();  // the papers' tracks are shown up to scale too
  pose.header.flags = ODO_POSE_ORIENTATION | ODO_POSE_COVARIANCE;
  if (placed) pose.header.flags |= ODO_POSE_POSITION;
  if (shows_metres()) pose.header.flags |= ODO_POSE_METRIC;
  if (shows_metres() && velocity_ != Velocity::none) pose.header.flags |= ODO_POSE_VELOCITY;
  const Quaterniond q_n_o = localizer_.q_n_o(), q_n_b = q_n_o * point.q_o_b;
  Vector3d p_n = localizer_.p_n() - q_n_o * (track_.newest().p_o_b - point.p_o_b);
  Eigen::Matrix<double, 6, 6> covariance = localizer_.pose_covariance(squared(p_.tilt_sigma_rad));
  if (camera_) {
    pose.header.flags |= ODO_POSE_CAMERA;
    const Vector3d lever_n = q_n_b * p_b_c_;
    p_n += lever_n;
    const Matrix3d by_theta = -skew(lever_n);
    covariance.bottomRows<3>() += (by_theta * covariance.topRows<3>()).eval();
    covariance.rightCols<3>() += (covariance.leftCols<3>() * by_theta.transpose()).eval();
  }
  put_quaternion(camera_ ? (q_n_b * q_b_c_).normalized() : q_n_b.normalized(), pose.q_n);
  Vector3d::Map(pose.p_n) = placed ? p_n : Vector3d(start_.position_m.data());
  Vector3d::Map(pose.velocity_n) = q_n_o * velocity_o_;
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance) = covariance;
  if (scale_.known() || (paper() && inputs_.scale)) {
    pose.scale = std::exp(localizer_.x[kLogScale]);
    pose.scale_sigma = pose.scale * localizer_.sigma(kLogScale);
  }
  pose.distance_m = distance_m_;
  pose.state = last_state_, pose.reason = last_reason_;
  return pose;
}

void Composer::publish(int64_t t_ns, uint32_t state, uint32_t reason) {
  auto point = track_.at(t_ns);
  if (!point) return;
  point->t_ns = t_ns;
  last_state_ = state, last_reason_ = reason;
  odo_pose pose = make_pose(*point);
  const Vector3d p_n(pose.p_n);
  if (last_pose_ns_ == INT64_MIN || !metric_) distance_from_ = p_n;
  if (const double moved_m = (p_n - distance_from_).norm(); !paper() && moved_m > p_.counted_m) {
    distance_m_ += moved_m;
    distance_from_ = p_n;
  }
  pose.distance_m = distance_m_;
  last_pose_ns_ = t_ns;
  pose_ = pose;
  if (!camera_) return;
  const double own = scale_.own_information();
  constexpr double kReferenceSigma = 0.03;  // relative: a scale less well known does not teach
  const bool teaches = own > 1 / squared(kReferenceSigma) && state != ODO_LOST && velocity_ != Velocity::none;
  if (const auto reference = reference_.see(pose, teaches)) step_reference_ = *reference;
}

/// A jump of the published track, announced from `part` of the parameters' sizes on.
void Composer::note_jump(const odo_pose& before, uint32_t reason, double part) {
  const auto point = track_.at(before.header.t_ns);
  if (!point || (before.header.flags & ODO_POSE_POSITION) == 0) return;
  const odo_pose after = make_pose(*point);
  const Quaterniond q = (raw_quaternion(after.q_n) * raw_quaternion(before.q_n).conjugate()).normalized();
  const Vector3d p_before(before.p_n), p_after(after.p_n);
  const double jump_m = (p_after - p_before).norm(), rotation_rad = log_rotation(q).norm();
  if (jump_m <= part * p_.announced_jump_m && rotation_rad <= part * p_.announced_rotation_rad) return;
  Correction now{before.header.t_ns, q, p_after - q * p_before, reason};
  if (correction_) now.q = (q * correction_->q).normalized(), now.p += q * correction_->p;
  correction_ = now;
  corrected_ = after;
  distance_from_ += p_after - p_before;
}

void Composer::prepare(odo_vo_motion& motion) const {
  Quaterniond q_n_c = q_b_c_;
  if (const auto point = started_ ? track_.at(motion.t_from_ns) : std::nullopt)
    q_n_c = localizer_.q_n_o() * point->q_o_b * q_b_c_;
  else if (started_)
    q_n_c = localizer_.q_n_o() * track_.newest().q_o_b * q_b_c_;
  put_quaternion(q_n_c, motion.q_n_c0);
  motion.header.flags |= ODO_FLAG_NAVIGATION;
}

int32_t Composer::at(int64_t t_ns, Estimate& out) const {
  if (!started_) return ODO_NOT_READY;
  const int64_t newest_ns = std::max(t_ns_, track_.newest().t_ns);
  if (t_ns == INT64_MIN) t_ns = newest_ns;
  if (t_ns > newest_ns && t_ns - newest_ns > kMaxExtrapolation_ns) return ODO_E_NOT_FOUND;
  const auto point = point_at(t_ns);
  if (!point) return ODO_E_NOT_FOUND;
  out.pose = make_pose(*point);
  if (t_ns > newest_ns) out.pose.header.flags |= ODO_POSE_EXTRAPOLATED;
  const Quaterniond q_n_o = localizer_.q_n_o();
  out.q_n_b = q_n_o * point->q_o_b;
  out.p_n_b = localizer_.p_n() - q_n_o * (track_.newest().p_o_b - point->p_o_b);
  out.v_n_b = q_n_o * velocity_o_;
  out.velocity_is_mean = velocity_ != Velocity::now;
  out.gyro_bias_b = gyro_bias_b_, out.accel_bias_b = accel_bias_b_;
  return ODO_OK;
}

bool Composer::take_pose(odo_pose& pose) { return take(pose_, pose); }

bool Composer::take_correction(Correction& correction, odo_pose& pose) {
  if (!corrected_) return false;
  take(corrected_, pose);
  return take(correction_, correction);
}

bool Composer::take_step_reference(odo_fix& reference) { return take(step_reference_, reference); }

}  // namespace odograph
