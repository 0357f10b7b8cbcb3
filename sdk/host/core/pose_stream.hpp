// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <mutex>

#include "sdk/host/base/rigid.hpp"
#include "sdk/host/base/saturating.hpp"
#include "sdk/host/core/pose_history.hpp"
#include "sdk/host/core/pose_predictor.hpp"

namespace odograph {

/// The phone's pose at a time: from the pipeline's poses where available, ahead of them by prediction. Thread-safe; the
/// pipeline writes, the session adds samples and queries.
class PoseStream {
 public:
  /// A pipeline that is further behind the samples is not "tracking".
  explicit PoseStream(int64_t max_gap_ns = INT64_MAX) : max_gap_ns_(max_gap_ns) {}

  /// The time of a message that the pipeline will take, and of one that it has processed. [any]
  void set_pushed(int64_t t_ns) { pushed_ns_ = std::max(t_ns, pushed_ns_.load()); }
  void set_processed(int64_t t_ns) { processed_ns_ = std::max(t_ns, processed_ns_.load()); }
  /// Takes a sample as it is pushed. [any]
  void add_imu(const odo_imu& imu) {
    const std::lock_guard lock(mutex_);
    predictor_.add_imu(imu);
  }
  /// Take the attitude and the state of the pipeline. [process]
  void add_attitude(const odo_attitude& attitude) {
    const std::lock_guard lock(mutex_);
    predictor_.add_attitude(attitude);
  }
  void set_state(uint32_t state, uint32_t reason) {
    const std::lock_guard lock(mutex_);
    predictor_.set_state(state, reason);
  }
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

  /// The corrected pose, or with `smooth` the one without jumps, at t or at the newest sample (INT64_MIN).
  /// ODO_NOT_READY; ODO_E_NOT_FOUND outside of the stored range. [any]
  int32_t at(int64_t t_ns, bool smooth, odo_pose& out) const {
    const std::lock_guard lock(mutex_);
    const bool ahead = t_ns == INT64_MIN || t_ns > predictor_.published_ns();
    if (!ahead) return history_.at(t_ns, smooth, out);
    const int32_t status = predictor_.at(t_ns, smooth, out);
    if (status == ODO_OK && out.state == ODO_TRACKING && is_behind())
      out.state = ODO_DEGRADED, out.reason = ODO_REASON_PLUGIN_FAILED;
    return status;
  }
  /// For a sensor clock that was set back. [any]
  void clear() {
    const std::lock_guard lock(mutex_);
    history_.clear();
    predictor_.clear();
    pushed_ns_ = processed_ns_ = INT64_MIN;
  }

 private:
  bool is_behind() const { return saturating_difference(pushed_ns_, processed_ns_) > max_gap_ns_; }

  const int64_t max_gap_ns_;
  std::atomic<int64_t> pushed_ns_{INT64_MIN}, processed_ns_{INT64_MIN};
  mutable std::mutex mutex_;  // guards what follows
  PoseHistory history_;
  PosePredictor predictor_;
};

}  // namespace odograph
