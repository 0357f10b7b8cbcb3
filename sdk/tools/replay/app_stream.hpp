// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/evaluation/stream_figures.hpp"
#include "sdk/tools/replay/arrivals.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

struct AppTiming {
  double ahead_ms = 30;  ///< prediction time of the queried poses after the poll
  double poll_hz = 60;
  Lateness late{};
};

/// Poses that an app received at its screen's refresh rate, and the durations of its calls.
struct AppStream {
  PoseStream poses;
  size_t corrections = 0;
  std::vector<double> poll_us, statistics_us;
};

/// Replays the recording in simulated time, each sample as late as an app delivers it.
Result<AppStream> app_stream(const Recording& recording, const RunOptions& run, const AppTiming& timing);

}  // namespace odograph
