// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/calibration/camera_imu.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

struct GuessedCameraOptions {
  double span_s = 40;            ///< length of the beginning that is used
  double rate_hz = 12;           ///< of its frames
  double search_s = 1;           ///< half-width of the search for the time offset if the frame times are guessed
  double min_correlation = 0.7;  ///< between the rotations of pictures and gyroscope, below which the guesses are kept
};

/// Checks the camera parameters that a reader guessed (Recording::guessed) against the gyroscope, and replaces those
/// that are observable (calibrate_camera_imu). The result, or the reason for none, becomes a warning of the recording.
/// No effect without guesses.
void refine_guessed_camera(Recording& recording, const GuessedCameraOptions& options = {},
                           const ProgressCallback& progress = {});

}  // namespace odograph
