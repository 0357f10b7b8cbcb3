// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "sdk/host/base/rigid.hpp"
#include "sdk/host/core/pose_history.hpp"
#include "sdk/host/core/pose_predictor.hpp"

namespace odograph {

/// The phone's pose at a time: from the pipeline's poses where available, ahead of them by prediction. Thread-safe; the
/// pipeline writes, the session adds samples and queries.
class PoseStream {
 public:
  /// Takes a sample as it is pushed. [any]
  void add_imu(const odo_imu& imu) { predictor_.add_imu(imu); }
  /// Takes a published pose and the state to predict from. [process]
  void add_pose(const odo_pose& pose, const PosePredictor::Base& base) {
    const std::lock_guard lock(mutex_);
    predictor_.add_pose(pose.header.t_ns, base);
    history_.push(pose, predictor_.smooth_pose(pose));
  }
  /// Moves all poses to the new n: a point x in the old n is at `correction` * x. [process]
  void correct(const Rigid& correction) {
    const std::lock_guard lock(mutex_);
    history_.correct(correction);
    predictor_.correct(correction);
  }
  PosePredictor& predictor() { return predictor_; }

  /// The corrected pose, or with `smooth` the one without jumps, at t or at the newest sample (INT64_MIN).
  /// ODO_NOT_READY; ODO_E_NOT_FOUND outside of the stored range. [any]
  int32_t at(int64_t t_ns, bool smooth, odo_pose& out) const {
    const std::lock_guard lock(mutex_);
    const bool ahead = t_ns == INT64_MIN || t_ns > predictor_.published_ns();
    return ahead ? predictor_.at(t_ns, smooth, out) : history_.at(t_ns, smooth, out);
  }
  /// For a sensor clock that was set back. [any]
  void clear() {
    const std::lock_guard lock(mutex_);
    history_.clear();
    predictor_.clear();
  }

 private:
  mutable std::mutex mutex_;  // history and predictor are corrected together
  PoseHistory history_;
  PosePredictor predictor_;
};

}  // namespace odograph
