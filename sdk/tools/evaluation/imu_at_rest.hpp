// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// Allan deviation of a simulated sensor at rest (rad/s or m/s^2), mean of its axes, and the value expected from its
/// error model.
struct AllanPoint {
  double averaging_s, simulated, expected;
};

/// For the gyroscope or the accelerometer, from 20 ms to a twentieth of the duration, two points per decade.
std::vector<AllanPoint> imu_at_rest(const Scenario::Imu& imu, bool gyroscope, double hours, uint64_t seed);

}  // namespace odograph
