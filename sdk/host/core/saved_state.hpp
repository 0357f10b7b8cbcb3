// SPDX-License-Identifier: Apache-2.0
//
// State of the plugins and the anchors as a blob (saved_parts.hpp), a part for each plugin, named by its id (with " #2"
// for its second instance).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sdk/host/core/anchors.hpp"
#include "sdk/host/core/plugin_roster.hpp"

namespace odograph {

std::vector<uint8_t> save_state(const PluginRoster& roster, const Anchors& anchors);
/// Passes each plugin its saved state and skips that of other plugins. ODO_E_DATA if the blob is damaged (nothing
/// changes), ODO_PARTIAL if a part is rejected (the others are restored).
Result<bool> load_state(std::span<const uint8_t> blob, const PluginRoster& roster, Anchors& anchors);

/// The same of the plugins' maps, with the anchors in the frame of each. Empty if no plugin has a map.
std::vector<uint8_t> save_maps(const PluginRoster& roster, const Anchors& anchors, const KeptPoses& poses);
/// ODO_E_DATA if a part is damaged, or of a plugin that is not there.
Result<bool> load_maps(std::span<const uint8_t> blob, const PluginRoster& roster, Anchors& anchors);

}  // namespace odograph
