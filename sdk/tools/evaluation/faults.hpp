// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sdk/host/config/spec.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Kinds of sensor faults.
enum class FaultKind {
  drop,     ///< samples are missing
  repeat,   ///< samples are delivered twice
  delay,    ///< samples are delivered later by `by`
  shift,    ///< their times are wrong by `by`
  value,    ///< every number reads `value`
  black,    ///< pictures are black
  damaged,  ///< pictures cannot be decoded
};

/// One entry of a faults file.
struct SensorFault {
  FaultKind kind = FaultKind::drop;
  std::string sensor;  ///< imu, accelerometer, gyroscope, magnetometer, barometer, gnss, camera or all
  double from_s = 0;   ///< after the recording's first message
  double for_s = 0;    ///< 0: to the end
  double part = 1;     ///< fraction of the samples, at random
  double by_s = 0;
  double value = 0;
};

struct SensorFaults {
  uint64_t seed = 0;
  std::vector<SensorFault> faults;
};

/// Schema of a faults file.
const Spec& faults_spec();
/// Failures as for a pipeline config, with file, line and column.
Result<SensorFaults> read_faults(const std::string& path);

/// The recording as delivered with these faults, applied in order. Reproducible for the same recording and faults.
/// Truth and sensor descriptions are unchanged.
Recording with_faults(const Recording& recording, const SensorFaults& faults);

}  // namespace odograph
