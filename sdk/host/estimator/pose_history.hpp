// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <mutex>
#include <vector>

#include <odograph/types.h>

namespace odograph {

/// How far beyond the newest pose one is told, with its velocity; chosen by hand, not tuned.
inline constexpr int64_t kMaxExtrapolation_ns = 500'000'000;

/// The last poses, to answer "where was it at t". No allocation after construction. Thread-safe: an app asks for the
/// pose while the pipeline works on the next frame.
class PoseHistory {
 public:
  explicit PoseHistory(size_t capacity = 1024) { poses_.reserve(capacity), capacity_ = capacity; }

  /// Poses come in the order of their time; one that does not replaces all later ones.
  void push(const odo_pose& pose);
  /// The orientation now, where it is known between poses (no camera: the position is as old as the last step).
  void set_orientation(int64_t t_ns, const std::array<double, 4>& q_n);

  /// The pose at t: interpolated (slerp and linear), or extrapolated with the last velocity by at most
  /// kMaxExtrapolation_ns and flagged so. ODO_NOT_READY when empty, ODO_E_NOT_FOUND outside.
  int32_t at(int64_t t_ns, odo_pose& out) const;
  void clear();

 private:
  const odo_pose& latest() const { return poses_[newest_]; }
  const odo_pose& nth(size_t i) const { return poses_[poses_.size() < capacity_ ? i : (newest_ + 1 + i) % capacity_]; }

  mutable std::mutex mutex_;
  std::vector<odo_pose> poses_;
  size_t capacity_;
  size_t newest_ = 0;
  int64_t oriented_ns_ = INT64_MIN;
  std::array<double, 4> orientation_{};
};

}  // namespace odograph
