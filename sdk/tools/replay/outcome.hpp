// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// Whether the input holds motion: the specific force varies as in a hand that walks, or GNSS moves.
bool holds_motion(const Recording& recording);

/// Why a run over input with motion came to nothing, with the likeliest reason: no pose, poses that never move, no
/// frame of a configured front-end used, or no scale where one was to come. Empty if it came to something, or the
/// inertial samples hold no motion and there are poses.
std::string why_nothing(const Recording& recording, const PipelineConfig& config, const RunResult& result);

/// The distance in its unit: "12.30 m", "12.30 units" without a metric scale, "still" for poses that need not move.
std::string distance_text(const RunResult& result);

/// Exit status of a completed run (docs/commands.md): losses, failed plugins, and a run that came to nothing or ended
/// lost.
int exit_status(const RunResult& result);

}  // namespace odograph
