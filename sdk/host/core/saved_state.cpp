// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/saved_state.hpp"

#include <algorithm>

#include "sdk/host/core/saved_anchor.hpp"
#include "sdk/host/core/saved_parts.hpp"

namespace odograph {

std::vector<uint8_t> save_state(const PluginRoster& roster, const Anchors& anchors) {
  PartWriter out(SavedKind::state);
  const auto names = roster.state_names();
  const auto& plugins = roster.plugins();
  for (size_t i = 0; i < plugins.size(); ++i) out.add(names[i], plugins[i]->save());
  out.add(kAnchorsPart, anchors.save());
  return out.finish();
}

Result<bool> load_state(std::span<const uint8_t> blob, const PluginRoster& roster, Anchors& anchors) {
  const auto parts = parts_of(blob, SavedKind::state);
  if (!parts) return Failure{ODO_E_DATA, "the blob is not a saved state, or it is damaged"};
  std::string refused;
  const auto names = roster.state_names();
  const auto& plugins = roster.plugins();
  for (const SavedPart& part : *parts)
    for (size_t i = 0; i < plugins.size(); ++i)
      if (names[i] == part.name && !plugins[i]->load(part.data)) refused += " " + plugins[i]->id();
  for (const SavedPart& part : *parts)
    if (part.name == kAnchorsPart && !anchors.load(part.data)) refused += " anchors";
  if (!refused.empty()) return Failure{ODO_PARTIAL, "saved state rejected by:" + refused};
  return true;
}

std::vector<uint8_t> save_maps(const PluginRoster& roster, const Anchors& anchors, const KeptPoses& poses) {
  const auto names = roster.state_names();
  const auto& plugins = roster.plugins();
  std::vector<std::vector<uint8_t>> bytes;  // that `maps` refers to
  std::vector<SavedMap> maps;
  for (size_t i = 0; i < plugins.size(); ++i) {
    SavedMap map{names[i], bytes.emplace_back(plugins[i]->save_map()), {}};
    if (map.data.empty()) continue;
    const uint32_t source = plugins[i]->number();
    std::optional<Rigid> T_n_m;  // nothing: a loaded map that was not recognised
    if (KeptPose frame; poses.kept_pose(poses.map_frame(source, map.id()), frame))
      T_n_m = Rigid{frame.q_n_b, frame.p_n_b};
    else if (!plugins[i]->has_loaded(map.id()))
      T_n_m = Rigid();  // a map of this session is in n
    map.anchors = bytes.emplace_back(anchors.save_in(T_n_m, source, map.id()));
    maps.push_back(std::move(map));
  }
  return bytes_of(maps);
}

Result<bool> load_maps(std::span<const uint8_t> blob, const PluginRoster& roster, Anchors& anchors) {
  const auto maps = maps_of(blob);
  if (!maps) return maps.failure();
  const auto names = roster.state_names();
  const auto plugin_of = [&](const SavedMap& map) {
    return static_cast<size_t>(std::find(names.begin(), names.end(), map.plugin) - names.begin());
  };
  const Failure no_anchors{ODO_E_DATA, "the anchors of a map are damaged, or too many"};
  // What can be refused before anything changes.
  size_t count = anchors.ids().size();
  for (const SavedMap& map : *maps) {
    const auto saved = map.anchors.empty() ? std::optional(std::vector<SavedAnchor>()) : saved_anchors_of(map.anchors);
    if (!saved || (count += saved->size()) > Anchors::Parameters().max_anchors) return no_anchors;
    if (plugin_of(map) == names.size())
      return Failure{ODO_E_DATA, "a map of " + map.plugin + ", which this config does not have"};
  }
  for (const SavedMap& map : *maps) {
    const auto& plugin = roster.plugins()[plugin_of(map)];
    if (!plugin->load_map(map.data)) return refused_map(plugin->id());
    if (!map.anchors.empty() && !anchors.load_in(map.anchors, plugin->number(), map.id())) return no_anchors;
  }
  return true;
}

}  // namespace odograph
