// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "sdk/host/checks/motion_check.hpp"
#include "sdk/host/checks/picture_check.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// Finds input whose values are possible and whose meaning is wrong: units, signs, axes, mounts, clocks. Each fault is
/// reported once when it appears and once when it is gone; while one lasts, no pose is "tracking"
/// (ODO_REASON_WRONG_INPUT).
class InputChecks {
 public:
  struct Parameters {
    int64_t too_dense_ns = 50'000;        ///< mean interval of an inertial sensor: 20 kHz; phones give 25 Hz to 1 kHz
    int64_t too_sparse_ns = 150'000'000;  ///< 7 Hz, at which a step has three samples
    int dense_samples = 100, sparse_samples = 10;  ///< in a row
    /// Of a frame's time after that of the newest inertial sample pushed, by 20 frames in a row: sensors deliver in
    /// batches of up to 0.1 s.
    int64_t frame_ahead_ns = 150'000'000;
    int frames_ahead = 20;
  };

  explicit InputChecks(HostServices& host);

  /// A sample as it is pushed, before it waits for slower sensors. [any]
  void on_push(const odo_header& sample);
  /// A sample in the order of time. [process]
  void on_sample(const odo_header& sample);
  /// A complete inertial sample in the order of time. [process]
  void on_imu(const odo_imu& imu);
  /// Whether a fault lasts. [any]
  bool any() const { return wrong_ != 0; }
  /// The sensor clock was set back. [process]
  void reset();

 private:
  void found(InputFault fault, bool wrong, double value, const SignedAxes& axes);

  Parameters p_;
  HostServices& host_;
  std::atomic<uint32_t> wrong_{0};  // by InputFault
  MotionCheck motion_;
  PictureCheck picture_;
  uint32_t camera_ = 0;
  bool has_camera_ = false;

  struct Times {
    int64_t first_ns = 0, newest_ns = 0;
    int samples = 0, sparse = 0;  ///< since first_ns; in a row with too long an interval
  };
  std::mutex mutex_;            // guards what follows
  int64_t imu_ns_ = INT64_MIN;  // of the newest sample pushed
  bool imu_since_frame_ = false;
  int frames_ahead_ = 0;          // in a row
  std::array<Times, 4> times_{};  // by the halves of an IMU that a sample has
};

}  // namespace odograph
