// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Delays with which an app delivers a recording's samples, in simulated time.
struct Lateness {
  double accel_hz = 104, imu_late_ms = 3, frame_late_ms = 45;
};

/// A sample of the recording at the time at which an app would push it.
struct Arrival {
  int64_t at_ns;
  odo_imu imu{};                           // if it is an IMU sample
  const RecordedMessage* other = nullptr;  // otherwise
};

/// Samples in order of arrival, pointing into the recording. The accelerometer is separate, at its own rate,
/// interpolated between the recording's samples.
std::vector<Arrival> arrivals_of(const Recording& recording, const Lateness& lateness);

}  // namespace odograph
