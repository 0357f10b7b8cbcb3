// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// Landmarks and surfaces at the end of a run, in its n, as scene.js expects them: coordinates one after the other, m.
nlohmann::ordered_json page_scene(const RunResult& result);

/// Times of key frames, of both ends of loops, and of poses in the map of an earlier session, s since t0.
nlohmann::ordered_json page_places(const RunResult& result, int64_t t0_ns);

}  // namespace odograph
