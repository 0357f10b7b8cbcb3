// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// How late an app hands in what a recording has, in simulated time.
struct Lateness {
  double accel_hz = 104, imu_late_ms = 3, frame_late_ms = 45;
};

/// A sample of the recording at the time at which an app would push it.
struct Arrival {
  int64_t at_ns;
  odo_imu imu{};                           // where it is one
  const RecordedMessage* other = nullptr;  // where it is not
};

/// In order of arrival. The accelerometer comes apart, at a rate of its own: interpolated between the recording's
/// samples. They point into the recording.
std::vector<Arrival> arrivals_of(const Recording& recording, const Lateness& lateness);

}  // namespace odograph
