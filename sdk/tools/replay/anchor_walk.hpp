// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "sdk/tools/replay/runner.hpp"

namespace odograph {

struct AnchorWalkOptions {
  double settle_s = 8, every_s = 1;  ///< s from the first position to the first anchors, and between them
  double ahead_m = 3;                ///< m from the camera to a new anchor
  double nearest_m = 2, farthest_m = 4, young_s = 0.2;  ///< range of distance, and minimum age, of scored anchors
  double mark_sigma_m = 0.02;                           ///< of the fix at the end
};

/// Errors of an app's anchors on the screen, and through a fix at the end of the walk.
struct AnchorFigures {
  std::vector<double> px, smooth_px;  ///< in the picture on its arrival, for anchors between nearest_m and farthest_m
  double start_off_m = NAN;           ///< error of content placed at the start, after the fix at the end
  double by_newest_m = NAN;           ///< the same if the newest correction had moved it
  double drift_m = NAN;               ///< of the phone before the fix
  double view_sigma_m = NAN;          ///< stated for the content at the start, seen from the end, before the fix
  bool fixed = false;
};

/// Replays a recording with camera, IMU and truth like an app that places anchors ahead of the camera, draws them in
/// each picture on arrival, and receives its true position at the end.
Result<AnchorFigures> anchor_walk(const Recording& recording, const RunOptions& run, const AnchorWalkOptions& options);

}  // namespace odograph
