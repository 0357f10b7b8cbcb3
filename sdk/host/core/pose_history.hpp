// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <odograph/types.h>

#include "sdk/host/base/rigid.hpp"
#include "sdk/math/timed_ring.hpp"

namespace odograph {

/// The last 1024 poses (half a minute at 30 Hz), for queries by time. No allocation. Not thread-safe.
class PoseHistory {
 public:
  /// Poses arrive in time order; one that is not newer replaces the newest. `smooth`: the smooth pose of that time.
  void push(const odo_pose& pose, const Rigid& smooth);
  /// Moves the poses to the new n: a point x in the old n is at `correction` * x. The smooth poses remain.
  void correct(const Rigid& correction) { T_n_0_ = correction * T_n_0_, ++corrections_; }
  /// The pose at t: interpolated (slerp and linear) between poses of the same part, body or camera; otherwise the
  /// nearer one. With `smooth`, orientation and position are those of the smooth poses. ODO_NOT_READY if empty,
  /// ODO_E_NOT_FOUND outside of the stored range.
  int32_t at(int64_t t_ns, bool smooth, odo_pose& out) const;
  void clear() { poses_.clear(); }

 private:
  struct Entry {
    int64_t t_ns = 0;
    odo_pose pose;
    Rigid smooth;
    Rigid T_n_0;               // n of the pose
    uint64_t corrections = 0;  // before it
  };

  odo_pose in_todays_n(const Entry& entry) const;

  TimedRing<Entry, 1024> poses_;
  Rigid T_n_0_;  // from the first n to today's
  uint64_t corrections_ = 0;
};

}  // namespace odograph
