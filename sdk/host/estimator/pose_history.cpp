// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/rotation.hpp"
#include "sdk/host/estimator/pose_history.hpp"

#include <algorithm>

#include <Eigen/Geometry>

namespace odograph {

void PoseHistory::set_orientation(int64_t t_ns, const std::array<double, 4>& q_n) {
  const std::lock_guard lock(mutex_);
  oriented_ns_ = t_ns;
  orientation_ = q_n;
}

void PoseHistory::clear() {
  const std::lock_guard lock(mutex_);
  poses_.clear();
  newest_ = 0;
  oriented_ns_ = INT64_MIN;
}

void PoseHistory::push(const odo_pose& pose) {
  const std::lock_guard lock(mutex_);
  if (!poses_.empty() && pose.header.t_ns <= latest().header.t_ns) {
    poses_[newest_] = pose;  // a correction of the latest
    return;
  }
  if (poses_.size() < capacity_) {
    poses_.push_back(pose);
    newest_ = poses_.size() - 1;
  } else {
    newest_ = (newest_ + 1) % capacity_;
    poses_[newest_] = pose;
  }
}

int32_t PoseHistory::at(int64_t t_ns, odo_pose& out) const {
  const std::lock_guard lock(mutex_);
  if (poses_.empty()) return ODO_NOT_READY;
  const odo_pose& last = latest();
  if (t_ns == INT64_MIN) t_ns = std::max(last.header.t_ns, oriented_ns_);
  if (t_ns == last.header.t_ns) {
    out = last;
    return ODO_OK;
  }
  if (t_ns > last.header.t_ns) {
    if (t_ns - std::max(last.header.t_ns, oriented_ns_) > kMaxExtrapolation_ns) return ODO_E_NOT_FOUND;
    out = last;
    const double dt = static_cast<double>(std::min(t_ns - last.header.t_ns, kMaxExtrapolation_ns)) * 1e-9;
    for (int i = 0; i < 3; ++i) out.p_n[i] += last.velocity_n[i] * dt;
    if (oriented_ns_ > last.header.t_ns) std::copy(orientation_.begin(), orientation_.end(), out.q_n);
    out.header.t_ns = t_ns;
    out.header.flags |= ODO_POSE_EXTRAPOLATED;
    return ODO_OK;
  }
  size_t low = 0, high = poses_.size() - 1;
  if (t_ns < nth(low).header.t_ns) return ODO_E_NOT_FOUND;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    (nth(middle).header.t_ns <= t_ns ? low : high) = middle;
  }
  const odo_pose &a = nth(low), &b = nth(high);
  const int64_t span = b.header.t_ns - a.header.t_ns;
  const double w = span > 0 ? static_cast<double>(t_ns - a.header.t_ns) / static_cast<double>(span) : 0.0;
  out = w < 0.5 ? a : b;
  out.header.t_ns = t_ns;
  const Eigen::Quaterniond q = raw_quaternion(a.q_n).slerp(w, raw_quaternion(b.q_n));
  put_quaternion(q, out.q_n);
  for (int i = 0; i < 3; ++i) out.p_n[i] = a.p_n[i] + w * (b.p_n[i] - a.p_n[i]);
  out.distance_m = a.distance_m + w * (b.distance_m - a.distance_m);
  return ODO_OK;
}

}  // namespace odograph
