// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/calibration/camera_imu.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

struct GuessedCameraOptions {
  double span_s = 40;            ///< of the recording's begin that is looked at
  double rate_hz = 12;           ///< of its frames
  double search_s = 1;           ///< of the time offset, where the frames' times are guessed
  double min_correlation = 0.7;  ///< of the pictures' rotation with the gyroscope's, below which nothing is taken
};

/// What a reader has guessed of the camera (Recording::guessed) is checked against the gyroscope, and replaced where
/// the recording shows it (calibrate_camera_imu). What was found, or why nothing was, is a warning of the recording.
/// Nothing is done where nothing was guessed.
void refine_guessed_camera(Recording& recording, const GuessedCameraOptions& options = {},
                           const ProgressCallback& progress = {});

}  // namespace odograph
