// SPDX-License-Identifier: Apache-2.0
//
// What the plugins have learnt, and the anchors, as a blob: "ODOSTATE", u32 version, u32 parts; of each part u32 and
// u64 lengths, the plugin's id (behind it " #2" for the second instance of it), and its bytes; at last a u64 FNV-1a of
// all before. Little-endian.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sdk/host/core/anchors.hpp"
#include "sdk/host/core/plugin_roster.hpp"

namespace odograph {

std::vector<uint8_t> save_state(const PluginRoster& roster, const Anchors& anchors);
/// Gives each plugin what it saved; other plugins' parts are passed over. A failure says what is wrong; nothing is
/// changed where the blob itself is damaged.
Result<bool> load_state(std::span<const uint8_t> blob, const PluginRoster& roster, Anchors& anchors);

}  // namespace odograph
