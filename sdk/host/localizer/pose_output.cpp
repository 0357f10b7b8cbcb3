// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/pose_output.hpp"

#include "sdk/math/rotation.hpp"

namespace odograph {

using Eigen::Quaterniond;
using Eigen::Vector3d;

void PoseOutput::publish(odo_pose pose, bool shown, double scale_sigma) {
  if (last_ns_ == INT64_MIN || !shown) counted_from_ = Vector3d(pose.p_n);
  last_ns_ = pose.header.t_ns;
  last_state_ = pose.state, last_reason_ = pose.reason;
  pose_ = pose;
  if ((pose.header.flags & ODO_POSE_CAMERA) == 0) return;
  const bool is_reference =
      scale_sigma > 0 && scale_sigma < p_.reference_scale_sigma && (pose.header.flags & ODO_POSE_VELOCITY) != 0;
  if (const auto reference = displacement_reference_.add_pose(pose, is_reference ? scale_sigma : 0))
    reference_ = *reference;
}

void PoseOutput::settle() {
  if (!pose_) return;
  const Vector3d p_n(pose_->p_n);
  if (const double moved_m = (p_n - counted_from_).norm(); !counts_all_ && moved_m > p_.counted_m) {
    distance_m_ += moved_m;
    counted_from_ = p_n;
  }
  pose_->distance_m = distance_m_;
}

void PoseOutput::correct(const odo_pose& before, odo_pose after, uint32_t reason, bool report_small) {
  if ((before.header.flags & ODO_POSE_POSITION) == 0) {
    if (reason == ODO_CORRECTION_FIX)
      counted_from_ += Vector3d(after.p_n) - Vector3d(before.p_n);  // its first position
    return;
  }
  const Quaterniond q = (raw_quaternion(after.q_n) * raw_quaternion(before.q_n).conjugate()).normalized();
  const Vector3d p_before(before.p_n), p_after(after.p_n);
  const double jump_m = (p_after - p_before).norm(), rotation_rad = log_rotation(q).norm();
  if (jump_m == 0 && rotation_rad < 1e-12) return;
  if (!report_small && jump_m <= p_.announced_jump_m && rotation_rad <= p_.announced_rotation_rad) return;
  Correction now{before.header.t_ns, q, p_after - q * p_before, reason};
  if (correction_) now.p += q * correction_->p, now.q = (q * correction_->q).normalized();
  correction_ = now;
  after.distance_m = distance_m_;
  corrected_ = after;
  counted_from_ += p_after - p_before;
}

}  // namespace odograph
