// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include <odograph/types.h>

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

/// An answer of odo_session_get_pose, and of odo_session_get_smooth_pose at the same time.
struct PolledPose {
  int64_t t_ns;
  odo_pose pose, smooth;
};

/// The poses that an app draws with.
struct PoseStream {
  std::map<int64_t, odo_pose> poses;  ///< the pipeline's own, as last corrected
  std::vector<PolledPose> polls;      ///< at the rate of the screen
  std::vector<PolledPose> early;      ///< each for the time of a frame that comes later
};

struct StreamFigures {
  size_t frames = 0;                                ///< early poses with a later one of the pipeline
  std::vector<double> orientation_deg, position_m;  ///< of these, off that one; positions where they had one
  size_t without_position = 0, repeated = 0;        ///< early poses; polls that look where the one before did
  double jump_m = 0, smooth_jump_m = 0;             ///< the longest step between two polls beyond the true one
};
/// Nothing before `start_ns` counts but in the jumps.
StreamFigures stream_figures(const PoseStream& stream, const Trajectory& truth, int64_t start_ns);

}  // namespace odograph
