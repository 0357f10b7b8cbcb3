// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Beyond every phone's sensor: the ranges in the data sheets of Bosch BMI270 and TDK ICM-42688 (2000 deg/s, 16 g) and
/// AKM AK09918 (4.9 mT), times two. One such sample would stay in a filter's sums for ever.
struct SensorRange {
  static constexpr double rate_radps = 70, force_mps2 = 320, field_t = 0.01;
};

}  // namespace odograph
