// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/math/ring.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

/// The newest orientations of the attitude source, q_a_b: 2.5 s at 200 Hz.
class AttitudeLog {
 public:
  void push(const odo_attitude& attitude) { entries_.push({attitude.header.t_ns, quaternion(attitude.q_n_b)}); }
  void clear() { entries_.clear(); }

  /// Whether the attitude source is still active at a time.
  bool covers(int64_t t_ns, int64_t reach_ns) const {
    return !entries_.empty() && t_ns - entries_.back(0).t_ns <= reach_ns;
  }
  /// The newest orientation that is not later than t, otherwise the oldest; nothing if empty.
  std::optional<Eigen::Quaterniond> at(int64_t t_ns) const {
    size_t i = 0;
    while (i + 1 < entries_.size() && entries_.back(i).t_ns > t_ns) ++i;
    return entries_.empty() ? std::nullopt : std::optional(entries_.back(i).q_a_b);
  }

 private:
  struct Entry {
    int64_t t_ns = 0;
    Eigen::Quaterniond q_a_b;
  };
  Ring<Entry, 512> entries_;
};

}  // namespace odograph
