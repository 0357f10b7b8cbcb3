// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "sdk/host/checks/course_check.hpp"
#include "sdk/host/checks/motion_check.hpp"
#include "sdk/host/checks/picture_check.hpp"
#include "sdk/host/checks/sampling_check.hpp"
#include "sdk/host/plugin_host/services.hpp"

namespace odograph {

/// Finds input whose values are possible and whose meaning is wrong: units, signs, axes, mounts, clocks. Each fault is
/// reported once when it appears and once when it is gone; while one lasts, no pose is "tracking"
/// (ODO_REASON_WRONG_INPUT).
class InputChecks {
 public:
  struct Parameters {
    /// Of a frame's time after that of the newest inertial sample pushed, by 20 frames in a row: sensors deliver in
    /// batches of up to 0.1 s.
    int64_t frame_ahead_ns = 150'000'000;
    int frames_ahead = 20;
    /// A receiver holds its position while it stands, and repeats an old one without satellites.
    double repeated_walk_s = 15;  ///< s of shaking as by steps while all positions are bit for bit the same
    int repeated_places = 5;
    /// The field points down in the north and up in the south. Its inclination is 18 to 69 degrees in real recordings.
    double min_latitude_rad = 0.35, min_dip_rad = 0.35;  ///< 20 degrees
    double max_step_s = 0.2;                             ///< between inertial samples that are integrated
    int wrong_dips = 10;                                 ///< seconds in a row
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
  void add(const odo_gnss& gnss);
  void add(const odo_magnetometer& magnetometer);

  Parameters p_;
  HostServices& host_;
  std::atomic<uint32_t> wrong_{0};  // by InputFault
  MotionCheck motion_;
  PictureCheck picture_;
  CourseCheck course_;
  uint32_t camera_ = 0;
  bool has_camera_ = false;
  odo_gnss place_{};       // the newest one that differs from those before
  double walked_s_ = 0;    // until it, see MotionCheck
  int places_ = 0;         // the same, since then
  int64_t turned_ns_ = 0;  // of the newest inertial sample
  int64_t dip_ns_ = 0;     // of the newest inclination
  int wrong_dips_ = 0;     // in a row

  std::mutex mutex_;            // guards what follows
  int64_t imu_ns_ = INT64_MIN;  // of the newest sample pushed
  bool imu_since_frame_ = false;
  int frames_ahead_ = 0;                     // in a row
  std::array<SamplingCheck, 4> sampling_{};  // by the halves of an IMU that a sample has
};

}  // namespace odograph
