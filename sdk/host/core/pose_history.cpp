// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/pose_history.hpp"

#include <cmath>

#include "sdk/host/base/pose_frame.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

using Eigen::Vector3d;

void PoseHistory::push(const odo_pose& pose, const Rigid& smooth) {
  // A correction of the newest pose does not change what was smooth.
  const bool again = !poses_.empty() && poses_.back(0).t_ns == pose.header.t_ns &&
                     ((poses_.back(0).pose.header.flags ^ pose.header.flags) & ODO_POSE_CAMERA) == 0;
  poses_.push({pose.header.t_ns, pose, again ? poses_.back(0).smooth : smooth, T_n_0_, corrections_});
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
  const size_t later = poses_.later_than(t_ns);
  if (later == poses_.size() || t_ns > poses_.back(0).t_ns) return ODO_E_NOT_FOUND;
  const Entry &older = poses_.back(later), &newer = poses_.back(later == 0 ? 0 : later - 1);
  const odo_pose a = in_todays_n(older), b = in_todays_n(newer);
  double w = later == 0 ? 1.0 : weight_between(older, newer, t_ns);
  if ((a.header.flags ^ b.header.flags) & ODO_POSE_CAMERA) w = std::round(w);  // their axes differ
  out = w < 0.5 ? a : b;
  out.header.t_ns = t_ns;
  const auto choose = [smooth](const Entry& entry, const odo_pose& pose) {
    return smooth ? entry.smooth : Rigid{raw_quaternion(pose.q_n), Vector3d(pose.p_n)};
  };
  const Rigid from = choose(older, a), to = choose(newer, b);
  put_quaternion(from.q.slerp(w, to.q), out.q_n);
  Vector3d::Map(out.p_n) = from.p + w * (to.p - from.p);
  out.distance_m = a.distance_m + w * (b.distance_m - a.distance_m);
  return ODO_OK;
}

}  // namespace odograph
