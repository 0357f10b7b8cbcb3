// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/pose_history.hpp"

#include "sdk/math/rotation.hpp"

namespace odograph {

void PoseHistory::clear() {
  const std::lock_guard lock(mutex_);
  poses_.clear();
}

void PoseHistory::push(const odo_pose& pose) {
  const std::lock_guard lock(mutex_);
  if (!poses_.empty() && pose.header.t_ns <= poses_.back(0).header.t_ns)
    poses_.back(0) = pose;  // a correction of the newest pose
  else
    poses_.push(pose);
}

int32_t PoseHistory::at(int64_t t_ns, odo_pose& out) const {
  const std::lock_guard lock(mutex_);
  if (poses_.empty()) return ODO_NOT_READY;
  size_t low = 0, high = poses_.size() - 1;  // indices back from the newest
  if (t_ns < poses_.back(high).header.t_ns || t_ns > poses_.back(0).header.t_ns) return ODO_E_NOT_FOUND;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    (poses_.back(middle).header.t_ns <= t_ns ? high : low) = middle;
  }
  const odo_pose &a = poses_.back(high), &b = poses_.back(low);
  const int64_t span_ns = b.header.t_ns - a.header.t_ns;
  const double w = span_ns > 0 ? static_cast<double>(t_ns - a.header.t_ns) / static_cast<double>(span_ns) : 1.0;
  out = w < 0.5 ? a : b;
  out.header.t_ns = t_ns;
  put_quaternion(raw_quaternion(a.q_n).slerp(w, raw_quaternion(b.q_n)), out.q_n);
  for (int i = 0; i < 3; ++i) out.p_n[i] = a.p_n[i] + w * (b.p_n[i] - a.p_n[i]);
  out.distance_m = a.distance_m + w * (b.distance_m - a.distance_m);
  return ODO_OK;
}

}  // namespace odograph
