// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/recording/recording.hpp"
#include "sdk/sim/journey.hpp"

namespace odograph {

/// How a real phone moved, as far as its own recording tells.
struct Retraced {
  Journey journey;
  int64_t start_ns = 0;                ///< the journey's time 0 on the phone's clock
  std::vector<Eigen::Vector3d> route;  ///< the waypoints, north, east, up; m
  double turn_rad = 0;                 ///< from the waypoints' map to the phone's own north
};

/// Orientation is the phone's own rotation vector. Position is the way between the waypoints, laid out smoothly in
/// time, 1.25 m above the floor, and on it what the accelerometer says about each step: its band above half a hertz,
/// integrated twice. The map is turned so that on the whole the walker goes where the phone points.
/// Failures (ODO_E_DATA) say what the recording lacks.
Result<Retraced> retrace(const Recording& recording);

}  // namespace odograph
