// SPDX-License-Identifier: Apache-2.0
//
// What fixes do to the track of PerFrameCoupling, at their own time.
#include <algorithm>
#include <cmath>

#include "sdk/host/base/rotation.hpp"
#include "sdk/host/estimator/per_frame_coupling.hpp"
#include "sdk/host/messages/messages.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using RowMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

}  // namespace

bool PerFrameCoupling::correct_gyro_attitude(const Vector3d& off_n, const odo_fix& fix) {
  Matrix3d R = Eigen::Map<const RowMatrix3d>(fix.orientation_cov_n);
  const auto theta_n = gyro_attitude_.correct(off_n, R, config_.fix_gate_sigma);
  if (!theta_n) return false;
  turned_by_fixes_ = true;
  heading_offset_rad_ += theta_n->z();
  q_n_ = gyro_attitude_.q_n_c();
  share_rotation_covariance();
  return true;
}

/// Orientation fixes by a gated Kalman update, heading and inclination apart; an attitude's inclination is left alone.
bool PerFrameCoupling::update_heading(const odo_fix& fix, const Quaterniond& q_then) {
  Vector3d theta_n = Vector3d::Zero();
  double yaw_variance = fix.yaw_sigma_rad * fix.yaw_sigma_rad, fix_tilt_variance = 0.0;
  const bool whole = (fix.header.flags & ODO_FIX_ORIENTATION) != 0;
  if (whole) {
    Quaterniond q = quaternion(fix.q_n_b);
    if (camera_) q = q * q_b_c_;
    const Eigen::AngleAxisd difference(q * q_then.conjugate());
    theta_n = difference.angle() * difference.axis();
    yaw_variance = fix.orientation_cov_n[8];
    fix_tilt_variance = std::max(fix.orientation_cov_n[0], fix.orientation_cov_n[4]);
  } else {
    const Vector3d axis_n = (camera_ ? q_then * q_b_c_.conjugate() : q_then) * Vector3d(fix.yaw_axis_b);
    theta_n.z() = std::remainder(fix.yaw_rad - std::atan2(axis_n.y(), axis_n.x()), 2 * EIGEN_PI);
  }
  if (whole && camera_ && config_.orientation == Orientation::gyroscope) return correct_gyro_attitude(theta_n, fix);
  const double gate = config_.fix_gate_sigma, S = heading_variance_ + yaw_variance + 1e-12;
  if (gate > 0 && theta_n.z() * theta_n.z() > gate * gate * S) return false;
  theta_n.z() *= heading_variance_ / S;
  heading_variance_ *= yaw_variance / S;
  if (whole && config_.orientation != Orientation::attitude) {
    const double gain = tilt_variance_ / (tilt_variance_ + fix_tilt_variance + 1e-12);
    theta_n.head<2>() *= gain;
    tilt_variance_ *= 1 - gain;
  } else {
    theta_n.head<2>().setZero();
  }
  turned_by_fixes_ = true;
  heading_offset_rad_ += theta_n.z();
  if (theta_n.norm() > 0) q_n_ = (exp_rotation(theta_n) * q_n_).normalized();
  share_rotation_covariance();
  return true;
}

/// The pose at a time before now as it is known now: with what fixes have corrected since it was published.
std::optional<odo_pose> PerFrameCoupling::pose_then(int64_t t_ns) const {
  odo_pose then{};
  if (history_.at(t_ns, then) != ODO_OK) return std::nullopt;
  Vector3d p_n(then.p_n);
  Quaterniond q_n = quaternion(then.q_n);
  for (size_t k = corrections_.size(); k > 0; --k) {  // the oldest first
    const Corrected& c = corrections_.back(k - 1);
    if (c.t_ns <= t_ns) continue;
    p_n = c.to_n + c.turned * (p_n - c.from_n);
    q_n = c.turned * q_n;
  }
  Vector3d::Map(then.p_n) = p_n;
  put_quaternion(q_n, then.q_n);
  return then;
}

UpdateResult PerFrameCoupling::on_fix(const odo_fix& fix) {
  const uint32_t flags = fix.header.flags;
  const Vector3d z(fix.p_n);
  const bool has_heading = (flags & (ODO_FIX_YAW | ODO_FIX_ORIENTATION)) != 0;
  // The fix speaks of its own time; what moved since then moved both.
  const auto then = pose_then(fix.header.t_ns);
  const Vector3d from_n = p_n_,
                 moved_since_n = then ? Vector3d(p_n_ - Vector3d(then->p_n)) : Vector3d(Vector3d::Zero());
  const Quaterniond q_before = q_n_, q_then = then ? quaternion(then->q_n) : q_n_;
  Vector3d innovation = z - (p_n_ - moved_since_n);
  Matrix3d R = Eigen::Map<const RowMatrix3d>(fix.covariance_n);
  for (int i = 0; i < 3; ++i) {
    if (flags & (ODO_FIX_NORTH << i)) continue;  // a component that the fix does not have
    innovation[i] = 0.0;
    R.row(i).setZero();
    R.col(i).setZero();
    R(i, i) = p_.uninformed_sigma_m * p_.uninformed_sigma_m;
  }
  if ((flags & (ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN)) == 0) {
    corrected_ = has_heading && update_heading(fix, q_then);
    if (corrected_) note_correction(q_before, from_n);
    return {corrected_, 0.0, 0};
  }
  Matrix3d P = position_covariance();
  if (!placed_ || rejected_in_a_row_ >= p_.max_consecutive_rejections)
    P = Matrix3d::Identity() * p_.uninformed_sigma_m * p_.uninformed_sigma_m;
  const Matrix3d S = P + R + Matrix3d::Identity() * 1e-9;
  const double gate = config_.fix_gate_sigma;
  const double nis = innovation.dot(S.ldlt().solve(innovation));
  int dof = 0;
  for (uint32_t flag : {ODO_FIX_NORTH, ODO_FIX_EAST, ODO_FIX_DOWN}) dof += (flags & flag) != 0;
  if (gate > 0 && nis > gate * gate) {
    ++rejected_in_a_row_;
    return {false, nis, dof};
  }
  // The fix that places a track nobody told its start tells its heading too, which may be any.
  if (!placed_ && (flags & ODO_FIX_ORIENTATION) != 0 && !start_.heading_given &&
      heading_variance_ >= p_.heading_unknown_rad * p_.heading_unknown_rad)
    heading_variance_ = std::max(heading_variance_, p_.any_heading_rad * p_.any_heading_rad);
  if (has_heading) update_heading(fix, q_then);  // a fix whose position is refused does not turn either
  const Matrix3d K = P * S.inverse();
  const Vector3d correction = K * innovation;
  // What moved since then was led by the heading that has just been mended.
  since_fix_n_ = (q_n_ * q_before.conjugate()) * moved_since_n;
  p_n_ += correction + since_fix_n_ - moved_since_n;
  independent_covariance_ = (Matrix3d::Identity() - K) * P;
  note_correction(q_before, from_n);
  unscaled_.reset();  // the fix knows where that led
  relative_sigma_ = unobserved_sigma_m_ = 0.0;
  placed_ = true;
  rejected_in_a_row_ = 0;
  corrected_ = true;
  return {true, nis, dof};
}

void PerFrameCoupling::note_correction(const Quaterniond& q_before, const Vector3d& from_n) {
  corrections_.push({last_pose_ns_, q_n_ * q_before.conjugate(), from_n, p_n_});
}

}  // namespace odograph
