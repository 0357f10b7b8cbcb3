// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/simulation/journey.hpp"

namespace odograph {

/// Motion of a real phone, estimated from its recording.
struct ReconstructedWalk {
  Journey journey;
  int64_t start_ns = 0;                ///< the journey's time 0 on the phone's clock
  std::vector<Eigen::Vector3d> route;  ///< the waypoints, north, east, up; m
  double yaw_rad = 0;                  ///< from the waypoints' map to the phone's north
};

/// Smooths a walk from the phone's accelerometer and gyroscope (smooth_walk), constrained by its waypoints, a hand
/// height of 1.25 m above the floor, and loosely by the phone's rotation vector. Pictures rendered along it agree with
/// the inertial samples up to the sensors' errors. The map is rotated so that, on average, the walker moves where the
/// phone points. Failures (ODO_E_DATA) state what the recording lacks.
Result<ReconstructedWalk> reconstruct_walk(const Recording& recording);

}  // namespace odograph
