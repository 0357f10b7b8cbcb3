// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <map>
#include <vector>

#include <odograph/types.h>

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

/// Results of odo_session_get_pose and odo_session_get_smooth_pose at the same time.
struct PolledPose {
  int64_t t_ns;
  odo_pose pose, smooth;
};

/// The poses that an app draws with.
struct PoseStream {
  std::map<int64_t, odo_pose> poses;  ///< the pipeline's own, as last corrected
  std::vector<PolledPose> polls;      ///< at the screen's refresh rate
  std::vector<PolledPose> early;      ///< each for the time of a later frame
};

struct StreamFigures {
  size_t frames = 0;                                ///< early poses with a later one of the pipeline
  std::vector<double> orientation_deg, position_m;  ///< difference to that one; positions if available
  size_t without_position = 0, repeated = 0;        ///< early poses; polls with the same view as the previous one
  double jump_m = 0, smooth_jump_m = 0;             ///< longest step between two polls minus the true one
  /// Of the smooth polls: how far they are behind the pipeline's later track, least squares, and the root mean square
  /// of the third difference of their positions over tenths of a second, in m/s^3; NaN without a moving track.
  double smooth_lag_s = NAN, smooth_jerk_mps3 = NAN;
  std::vector<double> live_m, smooth_m;  ///< distances of polls and smooth polls to the pipeline's later track
};
/// Only the jumps include data before `start_ns`.
StreamFigures stream_figures(const PoseStream& stream, const StampedPoses& truth, int64_t start_ns);

}  // namespace odograph
