// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// Landmarks and surfaces at the end of a run, in its n, as scene.js expects them: coordinates one after the other, m.
nlohmann::ordered_json page_scene(const RunResult& result);

}  // namespace odograph
