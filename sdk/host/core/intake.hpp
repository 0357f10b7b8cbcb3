// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "sdk/host/checks/input_checks.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/core/camera_table.hpp"
#include "sdk/host/core/frame_store.hpp"
#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/core/outbox.hpp"
#include "sdk/host/core/sample_gate.hpp"
#include "sdk/host/core/time_order.hpp"

namespace odograph {

/// Input stage between the app and the pipeline: checks each sample, takes ownership (borrowed memory is retained or
/// copied), converts its time to the IMU clock and inserts it into the time order. Unusable samples are refused,
/// counted and reported. Releases and reports happen without a lock. Outlives every message it returned. [any], but for
/// what requires the lock.
class Intake {
 public:
  struct Counts {
    std::atomic<uint64_t> pushed{0}, late{0}, duplicate{0}, invalid{0}, overflow{0}, wild{0};
  };
  enum class Next { nothing, restart, sample };
  using Lock = std::unique_lock<std::mutex>;

  /// `shared` may be null (see FrameStore). `poses` receives each inertial sample and is cleared when the clock is set
  /// back. `mutex` guards the time order; its owner's state changes with that. The references outlive this object.
  Intake(const PipelineConfig& config, SharedPixels* shared, CameraTable& cameras, InputChecks& checks,
         PoseStream& poses, HostServices& host, Outbox& outbox, std::mutex& mutex);

  /// Converts a sample to a message, or refuses it. Unknown types are accepted: a plugin may know them.
  int32_t take(const odo_header& sample, OwnedMessage& out);
  /// Inserts an accepted message into the time order. ODO_E_STATE after close(). Returns with the lock.
  int32_t add(OwnedMessage&& message, Lock& lock);
  /// Returns the pipeline's next action: restart, because the sensor clock was set back, or process `out`. Up to
  /// `flush_until_ns`, slower sensors are not waited for. Requires the lock.
  Next next(OwnedMessage& out, int64_t flush_until_ns);
  /// Whether next() without flush would return an action. Requires the lock.
  bool ready() const { return restarted_ || order_.ready(); }
  /// Requires the lock.
  int64_t latest_waiting_ns() const { return order_.latest_waiting_ns(); }
  /// The input ends here: discards and reports what is still held because its time is far ahead of all others.
  void end();
  /// Refuses all further samples.
  void close();
  /// Releases one waiting message; false if there is none.
  bool drop_one();
  const Counts& counts() const { return counts_; }

 private:
  int32_t check(const odo_header& sample, OwnedMessage& copy);
  int32_t borrow(odo_borrowed& message);
  bool is_first_source(const odo_header& sample);
  TimeOrder::Verdict order(OwnedMessage&& message, std::vector<OwnedMessage>& dropped);
  void accept(OwnedMessage&& message);
  void restart(std::vector<OwnedMessage>& dropped);
  int32_t refuse(std::atomic<uint64_t>& count, const char* key, const odo_header& sample, int32_t status,
                 const std::string& why);
  int32_t refuse_invalid(const odo_header& sample, int32_t status, const std::string& why) {
    return refuse(counts_.invalid, "invalid_", sample, status, why);
  }
  int32_t refuse_unordered(const odo_header& sample, TimeOrder::Verdict verdict, int64_t newest_ns);

  CameraTable& cameras_;
  InputChecks& checks_;
  PoseStream& poses_;
  HostServices& host_;
  Outbox& outbox_;
  FrameStore frames_;
  Counts counts_;
  std::array<std::atomic<int64_t>, 4>
      sources_;  // of gyroscope, accelerometer, magnetometer, barometer; negative: none yet

  std::mutex& mutex_;  // guards what follows
  SampleGate gate_;    // its ranges are constant
  TimeOrder order_;
  bool restarted_ = false, closed_ = false;
};

}  // namespace odograph
