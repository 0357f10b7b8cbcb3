// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/host/core/pose_predictor.hpp"
#include "sdk/host/core/pose_history.hpp"

namespace odograph {

/// The phone's pose at a time: from the pipeline's poses where available, ahead of them by prediction. Thread-safe,
/// like both parts; the pipeline writes, the session adds samples and queries.
class PoseStream {
 public:
  /// Takes a sample as it is pushed. [any]
  void add_imu(const odo_imu& imu) { predictor_.add_imu(imu); }
  /// Takes a published pose and the state to predict from. [process]
  void add_pose(const odo_pose& pose, const PosePredictor::Base& base) {
    history_.push(pose);
    predictor_.add_pose(pose.header.t_ns, base);
  }
  PosePredictor& predictor() { return predictor_; }

  /// The corrected pose, or with `smooth` the one without jumps, at t or at the newest sample (INT64_MIN).
  /// ODO_NOT_READY; ODO_E_NOT_FOUND outside of the stored range. [any]
  int32_t at(int64_t t_ns, bool smooth, odo_pose& out) const {
    if (t_ns == INT64_MIN || t_ns > predictor_.published_ns()) return predictor_.at(t_ns, smooth, out);
    const int32_t status = history_.at(t_ns, out);
    if (status == ODO_OK && smooth) predictor_.apply_smoothing(out);
    return status;
  }
  /// For a sensor clock that was set back. [any]
  void clear() {
    history_.clear();
    predictor_.clear();
  }

 private:
  PoseHistory history_;
  PosePredictor predictor_;
};

}  // namespace odograph
