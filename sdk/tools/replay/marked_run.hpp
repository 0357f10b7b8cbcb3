// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// True positions given to a session from its first metric pose on, in the frame of its track, with a simulated error.
struct MarkOptions {
  double sigma_m = 0, every_s = 20;  ///< 0 m: none
  uint64_t seed = 1;
};

/// The metric poses as last corrected, and the ratio of recorded time to one core's processor time, including picture
/// decoding.
struct MarkedRun {
  std::vector<odo_pose> poses;
  double times_realtime = 0;
};

/// Replays the first seconds of a recording. With marks, its own waypoints are skipped.
Result<MarkedRun> marked_run(const Recording& recording, const RunOptions& run, const MarkOptions& marks,
                             double first_s);

}  // namespace odograph
