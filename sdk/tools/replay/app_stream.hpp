// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/evaluation/stream_figures.hpp"
#include "sdk/tools/replay/arrivals.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

struct AppTiming {
  double ahead_ms = 30;  ///< poses are asked for so long after the poll
  double poll_hz = 60;
  Lateness late{};
};

/// What an app got that asks for poses at the rate of its screen, and how long its calls took.
struct AppStream {
  PoseStream poses;
  size_t corrections = 0;
  std::vector<double> poll_us, statistics_us;
};

/// The recording in simulated time, each sample handed in as late as an app has it.
Result<AppStream> app_stream(const Recording& recording, const RunOptions& run, const AppTiming& timing);

}  // namespace odograph
