// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include <odograph/types.h>

#include "sdk/math/ring.hpp"

namespace odograph {

/// The last 1024 poses (half a minute at 30 Hz), for queries by time. No allocation. Thread-safe: the app queries poses
/// while the pipeline works on the next frame.
class PoseHistory {
 public:
  /// Poses arrive in time order; one that is not newer replaces the newest.
  void push(const odo_pose& pose);
  /// The pose at t: interpolated (slerp and linear). ODO_NOT_READY if empty, ODO_E_NOT_FOUND outside of the stored
  /// range.
  int32_t at(int64_t t_ns, odo_pose& out) const;
  void clear();

 private:
  mutable std::mutex mutex_;
  Ring<odo_pose, 1024> poses_;
};

}  // namespace odograph
