// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "sdk/host/checks/signed_axes.hpp"

namespace odograph {

/// What can be wrong with an input although each of its values is possible: one row each of the table in
/// input_checks.cpp.
enum class InputFault : uint8_t {
  accel_in_g,
  accel_without_gravity,
  accel_level,
  accel_clipped,
  accel_filtered,
  gyro_in_degrees,
  gyro_sign,
  gyro_silent,
  gyro_bias,
  imu_axes,
  gyro_wrong,
  picture_turned,
  picture_mirrored,
  camera_mount,
  focal_length,
  principal_point,
  picture_time,
  camera_clock,
  picture_repeated,
  picture_overlay,
  picture_rows,
  time_unit,
  imu_slow,
  imu_batched,
  imu_repeated,
  imu_half_filled,
  gnss_unset,
  gnss_repeated,
  gnss_mirrored,
  gnss_velocity,
  magnetometer_axes,
  kCount
};

/// Of a check: whether a fault is there or, once the same motion shows it, no longer, with the measured value.
using FaultFound = std::function<void(InputFault fault, bool wrong, double value, const SignedAxes& axes)>;

}  // namespace odograph
