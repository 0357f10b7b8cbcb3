// SPDX-License-Identifier: Apache-2.0
//
// The maps of an instance, which cross in pieces.
#include <algorithm>
#include <cstring>

#include "sdk/host/plugin_host/instance.hpp"

namespace odograph {
namespace {

bool pass_map(PluginBackend& backend, std::span<const uint8_t> map) {
  for (size_t at = 0; at < map.size(); at += ODO_LARGEST_PIECE)
    if (!backend.take_map_piece(at, map.subspan(at, std::min<size_t>(ODO_LARGEST_PIECE, map.size() - at))))
      return false;
  return backend.take_map_piece(map.size(), {});
}

/// The first eight bytes (odo_plugin.save_map); 0 of fewer.
uint64_t id_of(std::span<const uint8_t> map) {
  uint64_t id = 0;
  if (map.size() >= sizeof id) std::memcpy(&id, map.data(), sizeof id);
  return id;
}

}  // namespace

/// Those that it was given, to a backend that starts anew.
void PluginInstance::pass_maps(PluginBackend& backend) const {
  for (const auto& map : maps_) pass_map(backend, map);
}

std::vector<uint8_t> PluginInstance::save_map() const {
  std::vector<uint8_t> map;
  if (!alive()) return map;
  for (std::vector<uint8_t> piece; !(piece = backend_->map_piece(map.size())).empty();) {
    if (map.size() + piece.size() > ODO_LARGEST_MAP) {
      host_.report(number_, ODO_SEVERITY_ERROR, "map_too_large",
                   "has a map of more than " + std::to_string(ODO_LARGEST_MAP) + " bytes: nothing of it is saved",
                   ODO_E_EXHAUSTED);
      return {};
    }
    map.insert(map.end(), piece.begin(), piece.end());
  }
  return has_ended() ? std::vector<uint8_t>() : map;
}

bool PluginInstance::load_map(std::span<const uint8_t> data) {
  if (!alive() || !pass_map(*backend_, data)) return false;
  std::erase_if(maps_, [&](const std::vector<uint8_t>& loaded) { return id_of(loaded) == id_of(data); });
  maps_.emplace_back(data.begin(), data.end());
  return true;
}

bool PluginInstance::has_loaded(uint64_t map) const {
  return std::any_of(maps_.begin(), maps_.end(),
                     [map](const std::vector<uint8_t>& loaded) { return id_of(loaded) == map; });
}

}  // namespace odograph
