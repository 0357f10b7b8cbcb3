// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/core/camera_table.hpp"
#include "sdk/host/core/frame_store.hpp"
#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/core/outbox.hpp"
#include "sdk/host/core/sample_gate.hpp"
#include "sdk/host/core/time_order.hpp"

namespace odograph {

/// What an app pushes, on its way to the pipeline: checked, made the session's own (borrowed memory is retained or
/// copied), brought onto the IMU's clock, and put into the order of time. What cannot be used is refused, counted and
/// reported. No lock is held while anything is released or reported. Outlives every message it gave. [any]
class Intake {
 public:
  struct Counts {
    std::atomic<uint64_t> pushed{0}, late{0}, duplicate{0}, invalid{0}, overflow{0}, wild{0};
  };
  enum class Next { nothing, restart, sample };

  /// `shared` may be null (see FrameStore). `poses` is given each inertial sample, and cleared where the clock is set
  /// back. The references outlive it.
  Intake(const PipelineConfig& config, SharedPixels* shared, CameraTable& cameras, PoseStream& poses,
         HostServices& host, Outbox& outbox);

  /// The sample as a message, or why it is refused. What no one knows is taken: a plugin may.
  int32_t take(const odo_header& sample, OwnedMessage& out);
  /// Puts what was taken into the order of time. ODO_E_STATE once it is closed.
  int32_t add(OwnedMessage message);
  /// What the pipeline is to do next: to start anew, because the sensor clock was set back, or to process `out`. Up to
  /// `flush_until_ns` no slower sensor is waited for.
  Next next(OwnedMessage& out, int64_t flush_until_ns);
  /// True when next without flush would give something.
  bool ready() const;
  int64_t latest_waiting_ns() const;
  /// Takes nothing more.
  void close();
  /// Releases one message that waits; false where none does.
  bool drop_one();
  const Counts& counts() const { return counts_; }

 private:
  int32_t borrow(odo_borrowed& message);
  TimeOrder::Verdict order(OwnedMessage message, std::vector<OwnedMessage>& given_up);
  void restart(std::vector<OwnedMessage>& given_up);
  int32_t refuse(std::atomic<uint64_t>& count, const char* key, const odo_header& sample, int32_t status,
                 const std::string& why);
  int32_t refuse_invalid(const odo_header& sample, int32_t status, const std::string& why) {
    return refuse(counts_.invalid, "invalid_", sample, status, why);
  }
  int32_t refuse_unordered(const odo_header& sample, TimeOrder::Verdict verdict);

  CameraTable& cameras_;
  PoseStream& poses_;
  HostServices& host_;
  Outbox& outbox_;
  FrameStore frames_;
  Counts counts_;

  mutable std::mutex mutex_;  // for what follows
  SampleGate gate_;           // its ranges never change
  TimeOrder order_;
  bool restarted_ = false, closed_ = false;
};

}  // namespace odograph
