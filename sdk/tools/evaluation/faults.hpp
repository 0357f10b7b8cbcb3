// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sdk/host/config/spec.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// What goes wrong with a sensor.
enum class FaultKind {
  drop,     ///< samples are missing
  repeat,   ///< samples come twice
  delay,    ///< samples are delivered later by `by`
  shift,    ///< their times are wrong by `by`
  value,    ///< they read `value` in every number
  black,    ///< pictures show nothing
  damaged,  ///< pictures cannot be read
};

/// One line of a faults file.
struct SensorFault {
  FaultKind kind = FaultKind::drop;
  std::string sensor;  ///< imu, accelerometer, gyroscope, magnetometer, barometer, gnss, camera or all
  double from_s = 0;   ///< after the recording's first message
  double for_s = 0;    ///< 0: to the end
  double part = 1;     ///< of the samples, by chance
  double by_s = 0;
  double value = 0;
};

struct SensorFaults {
  uint64_t seed = 0;
  std::vector<SensorFault> faults;
};

/// The table of a faults file.
const Spec& faults_spec();
/// Failures as of a pipeline config, with file, line and column.
Result<SensorFaults> read_faults(const std::string& path);

/// The recording as it would have been delivered with these faults, one after the other. The same for the same
/// recording and faults. Truth and descriptions of the sensors stay.
Recording with_faults(const Recording& recording, const SensorFaults& faults);

}  // namespace odograph
