// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/host/core/pose_predictor.hpp"
#include "sdk/host/core/pose_history.hpp"

namespace odograph {

/// Answers where the phone is at a time: from the pipeline's poses where there are any, ahead of them by prediction.
/// Thread-safe, as its two halves are; the pipeline writes, the session hands in samples and asks.
class PoseStream {
 public:
  /// A sample as it was pushed. [any]
  void add_imu(const odo_imu& imu) { predictor_.add_imu(imu); }
  /// A pose that is published, and what is to be carried on from. [process]
  void add_pose(const odo_pose& pose, const PosePredictor::Base& base) {
    history_.push(pose);
    predictor_.add_pose(pose.header.t_ns, base);
  }
  PosePredictor& predictor() { return predictor_; }

  /// The corrected pose, or (`smooth`) the one without jumps, at t or at the newest sample (INT64_MIN).
  /// ODO_NOT_READY, ODO_E_NOT_FOUND outside. [any]
  int32_t at(int64_t t_ns, bool smooth, odo_pose& out) const {
    if (t_ns == INT64_MIN || t_ns > predictor_.published_ns()) return predictor_.at(t_ns, smooth, out);
    const int32_t status = history_.at(t_ns, out);
    if (status == ODO_OK && smooth) predictor_.smoothen(out);
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
