// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// Places told to a session from its first metric pose on, in the frame of its track, with an error of their own.
struct MarkOptions {
  double sigma_m = 0, every_s = 20;  ///< 0 m: none are told
  uint64_t seed = 1;
};

/// The metric poses as last corrected, and the recorded time by one core's time, pictures read and decoded.
struct MarkedRun {
  std::vector<odo_pose> poses;
  double times_realtime = 0;
};

/// The recording's first seconds. With marks its own waypoints are left out.
Result<MarkedRun> marked_run(const Recording& recording, const RunOptions& run, const MarkOptions& marks,
                             double first_s);

}  // namespace odograph
