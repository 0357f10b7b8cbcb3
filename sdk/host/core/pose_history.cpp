// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/pose_history.hpp"

#include <cmath>

#include "sdk/host/base/pose_frame.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

using Eigen::Vector3d;

void PoseHistory::push(const odo_pose& pose, const Rigid& smooth) {
  const Entry entry{pose, smooth, T_n_0_, corrections_};
  if (!poses_.empty() && pose.header.t_ns <= poses_.back(0).pose.header.t_ns)
    poses_.back(0) = entry;  // a correction of the newest pose
  else
    poses_.push(entry);
}

/// Corrections are applied when a pose is queried: a query never waits for a thousand poses to be corrected.
odo_pose PoseHistory::in_todays_n(const Entry& entry) const {
  odo_pose pose = entry.pose;
  if (entry.corrections == corrections_) return pose;
  const Rigid correction = T_n_0_ * entry.T_n_0.inverse();
  move_frame(correction.q, correction.p, pose);
  return pose;
}

int32_t PoseHistory::at(int64_t t_ns, bool smooth, odo_pose& out) const {
  if (poses_.empty()) return ODO_NOT_READY;
  size_t low = 0, high = poses_.size() - 1;  // indices back from the newest
  if (t_ns < poses_.back(high).pose.header.t_ns || t_ns > poses_.back(0).pose.header.t_ns) return ODO_E_NOT_FOUND;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    (poses_.back(middle).pose.header.t_ns <= t_ns ? high : low) = middle;
  }
  const odo_pose a = in_todays_n(poses_.back(high)), b = in_todays_n(poses_.back(low));
  const int64_t span_ns = b.header.t_ns - a.header.t_ns;
  double w = span_ns > 0 ? static_cast<double>(t_ns - a.header.t_ns) / static_cast<double>(span_ns) : 1.0;
  if ((a.header.flags ^ b.header.flags) & ODO_POSE_CAMERA) w = std::round(w);  // their axes differ
  out = w < 0.5 ? a : b;
  out.header.t_ns = t_ns;
  const auto choose = [smooth](const Entry& entry, const odo_pose& pose) {
    return smooth ? entry.smooth : Rigid{raw_quaternion(pose.q_n), Vector3d(pose.p_n)};
  };
  const Rigid from = choose(poses_.back(high), a), to = choose(poses_.back(low), b);
  put_quaternion(from.q.slerp(w, to.q), out.q_n);
  Vector3d::Map(out.p_n) = from.p + w * (to.p - from.p);
  out.distance_m = a.distance_m + w * (b.distance_m - a.distance_m);
  return ODO_OK;
}

}  // namespace odograph
