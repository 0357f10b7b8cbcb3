// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "sdk/tools/replay/runner.hpp"

namespace odograph {

struct AnchorWalkOptions {
  double settle_s = 8, every_s = 1;  ///< from the first position to the first anchors, and between them
  double ahead_m = 3;                ///< from the camera to a new anchor
  double nearest_m = 2, farthest_m = 4, young_s = 0.2;  ///< which anchors' drawing is scored: distance, least age
  double mark_sigma_m = 0.02;                           ///< of the fix at the end
};

/// What an app's anchors did on the screen and through a fix at the end of the walk.
struct AnchorFigures {
  std::vector<double> px, smooth_px;  ///< on the picture as it arrives, of anchors between nearest_m and farthest_m
  double start_off_m = NAN;           ///< what was placed at the start, after the finish's fix
  double by_newest_m = NAN;           ///< the same if it had been moved by the newest correction
  double drift_m = NAN;               ///< of the phone before the fix
  double view_sigma_m = NAN;          ///< what was said of the content at the start, seen from the finish, before it
  bool fixed = false;
};

/// A recording with camera, IMU and truth as an app plays it that places anchors before the camera, draws them on each
/// picture as it arrives, and is told at the end where it is.
Result<AnchorFigures> anchor_walk(const Recording& recording, const RunOptions& run, const AnchorWalkOptions& options);

}  // namespace odograph
