// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "sdk/tools/evaluation/vo_figures.hpp"
#include "sdk/tools/plot/plot.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// What `bench vo` says of one recording and config: the metre, the shape whatever its scale, consistency, cost. Keys
/// end in their unit; null where the recording has no truth or the odometry no metre.
nlohmann::ordered_json vo_row(const Recording& recording, const RunResult& result);

/// The odometry's scale along the true path: of metric windows as it is, otherwise by its median.
PlotSeries scale_series(const Recording& recording, const RunResult& result, const std::string& name);

}  // namespace odograph
