// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/benchmarks/bench_table.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// What `bench vo` says of one recording and config: the metre, the shape whatever its scale, consistency, cost. Keys
/// end in their unit; null where the recording has no truth or the odometry no metre. `_scale`: the scale along the
/// true path, of metric windows as it is, otherwise by its median.
Json vo_row(const Recording& recording, const RunResult& result);

}  // namespace odograph
