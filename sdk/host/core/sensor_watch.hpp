// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <odograph/types.h>

#include "sdk/host/base/saturating.hpp"

namespace odograph {

/// Detects when an active sensor, or all of them, become silent, in sensor time.
class SensorWatch {
 public:
  explicit SensorWatch(double max_gap_s) : max_gap_ns_(static_cast<int64_t>(max_gap_s * 1e9)) {}

  /// An interval in which no message arrived.
  struct Pause {
    int64_t from_ns = INT64_MIN, to_ns = INT64_MIN;
    /// Whether an interval spans the pause.
    bool is_within(int64_t begin_ns, int64_t end_ns) const {
      return begin_ns <= from_ns && end_ns >= to_ns && to_ns > from_ns;
    }
  };

  /// Call with every message in order. Returns whether it ends a pause: no message came before it for longer than the
  /// maximum gap of a sensor.
  bool on_message(const odo_header& message) {
    const bool paused = now_ns_ != INT64_MIN && saturating_difference(message.t_ns, now_ns_) > max_gap_ns_;
    if (paused) pause_ = {now_ns_, message.t_ns};
    if (message.t_ns > now_ns_) now_ns_ = message.t_ns;
    if (message.type == ODO_TYPE_IMU) count_gap(imu_ns_, message.t_ns);
    if (message.type == ODO_TYPE_FRAME) count_gap(frame_ns_, message.t_ns);
    return paused;
  }
  /// The newest pause.
  const Pause& pause() const { return pause_; }
  bool imu_silent() const { return silent(imu_ns_); }
  bool camera_silent() const { return silent(frame_ns_); }
  /// Whether a time (INT64_MIN: none) is at most the maximum gap of a sensor ago.
  bool recent(int64_t t_ns) const { return t_ns != INT64_MIN && saturating_difference(now_ns_, t_ns) <= max_gap_ns_; }
  int64_t now_ns() const { return now_ns_; }
  uint64_t gaps() const { return gaps_; }
  void reset() {
    imu_ns_ = frame_ns_ = now_ns_ = INT64_MIN;
    pause_ = {};
  }

 private:
  void count_gap(int64_t& last_ns, int64_t t_ns) {
    if (last_ns != INT64_MIN && saturating_difference(t_ns, last_ns) > max_gap_ns_) ++gaps_;
    last_ns = t_ns;
  }
  bool silent(int64_t last_ns) const {
    return last_ns != INT64_MIN && saturating_difference(now_ns_, last_ns) > max_gap_ns_;
  }

  int64_t max_gap_ns_;
  int64_t imu_ns_ = INT64_MIN, frame_ns_ = INT64_MIN, now_ns_ = INT64_MIN;
  Pause pause_;
  uint64_t gaps_ = 0;
};

}  // namespace odograph
