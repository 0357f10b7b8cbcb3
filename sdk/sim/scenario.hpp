// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/config/spec.hpp"

namespace odograph {

/// What `odograph sim` is asked for. Every number is a key of the scenario file (scenario_spec).
struct Scenario {
  std::string world = "street";
  double walker_height_m = 1.70;
  double speed_mps = 1.35;
  double step_length_m = 0.72;  // at that speed
  double stand_s = 2.0;         // before and after walking
  double straight_m = 18.0;     // before and after the turn
  double turn_rad = 1.2;
  double turn_radius_m = 4.0;
  double pitch_rad = -0.2;
  int width = 640, height = 480;
  double focal_px = 500.0;
  double camera_hz = 10.0;
  double pixel_noise = 2.0;
  int jpeg_quality = 92;
  double imu_hz = 200.0;
  double gyro_noise = 1e-3, gyro_walk = 1e-5, accel_noise = 1e-2, accel_walk = 1e-4;
  double gyro_bias = 5e-3, accel_bias = 5e-2;
  double gnss_sigma_m = 4.0;
};

/// The table of scenario files.
const Spec& scenario_spec();
/// Failures name file, line and column, and the nearest valid key.
Result<Scenario> read_scenario(const std::string& path);

}  // namespace odograph
