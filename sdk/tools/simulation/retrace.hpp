// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/simulation/journey.hpp"

namespace odograph {

/// How a real phone moved, as far as its own recording tells.
struct Retraced {
  Journey journey;
  int64_t start_ns = 0;                ///< the journey's time 0 on the phone's clock
  std::vector<Eigen::Vector3d> route;  ///< the waypoints, north, east, up; m
  double yaw_rad = 0;                  ///< from the waypoints' map to the phone's own north
};

/// The walk that the phone's own accelerometer and gyroscope felt (smooth_walk), held by its waypoints, by a hand
/// 1.25 m above the floor and loosely by the phone's own rotation vector; so that pictures rendered along it agree with
/// those samples but for the sensors' errors. The map is turned so that on the whole the walker goes where the phone
/// points.
/// Failures (ODO_E_DATA) say what the recording lacks.
Result<Retraced> retrace(const Recording& recording);

}  // namespace odograph
