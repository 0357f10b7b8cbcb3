// SPDX-License-Identifier: Apache-2.0
//
// The file of a state or of maps: "ODOSTATE", or "ODOMAP" and two zeros, u32 version, u32 parts; for each part u32 and
// u64 lengths, its name, and its bytes; finally a u64 FNV-1a of everything before. Little-endian.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sdk/host/base/result.hpp"

namespace odograph {

enum class SavedKind { state, map };

/// The host's own part of a state; in a file of maps, before the name of the plugin whose map they are in.
inline constexpr std::string_view kAnchorsPart = "host anchors/1";

struct SavedPart {
  std::string name;
  std::span<const uint8_t> data;
};
/// Nothing if the bytes are not of this kind and version, or damaged.
std::optional<std::vector<SavedPart>> parts_of(std::span<const uint8_t> blob, SavedKind kind);

/// Writes what parts_of() reads. Parts without bytes are left out.
class PartWriter {
 public:
  explicit PartWriter(SavedKind kind);
  void add(std::string_view name, std::span<const uint8_t> data);
  bool empty() const { return count_ == 0; }
  std::vector<uint8_t> finish();

 private:
  std::vector<uint8_t> blob_;
  uint32_t count_ = 0;
};

/// The map of a plugin, and the anchors in its frame (saved_anchor.hpp).
struct SavedMap {
  std::string plugin;  ///< its id, with " #2" for its second instance
  std::span<const uint8_t> data, anchors;

  /// The first eight bytes of the data (odo_plugin.save_map); 0 if it has fewer.
  uint64_t id() const;
};
/// ODO_E_DATA if they are not maps, or damaged.
Result<std::vector<SavedMap>> maps_of(std::span<const uint8_t> blob);
/// Writes what maps_of() reads; empty without a map.
std::vector<uint8_t> bytes_of(std::span<const SavedMap> maps);
/// That the plugin refuses a map.
Failure refused_map(const std::string& plugin);

}  // namespace odograph
