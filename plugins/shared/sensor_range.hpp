// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Twice the ranges in the data sheets of Bosch BMI270 and TDK ICM-42688 (2000 deg/s, 16 g) and AKM AK09918 (4.9 mT). A
/// single larger sample would stay in a filter's sums forever.
struct SensorRange {
  static constexpr double rate_radps = 70, force_mps2 = 320, field_t = 0.01;
};

}  // namespace odograph
