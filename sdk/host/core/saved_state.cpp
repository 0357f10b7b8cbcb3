// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/saved_state.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

#include "sdk/host/core/saved_anchor.hpp"

namespace odograph {
namespace {

static_assert(std::endian::native == std::endian::little, "the blob is written as the machine has its numbers");

using Magic = char[8];
constexpr Magic kStateMagic = {'O', 'D', 'O', 'S', 'T', 'A', 'T', 'E'},
                kMapMagic = {'O', 'D', 'O', 'M', 'A', 'P', 0, 0};
constexpr uint32_t kVersion = 1;                         // of both
constexpr std::string_view kAnchors = "host anchors/1";  // the host's own part; in a map of the plugin named behind it

uint64_t fnv1a(std::span<const uint8_t> bytes) {
  uint64_t hash = 14695981039346656037u;
  for (const uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211u;
  return hash;
}

template <class T>
void put(std::vector<uint8_t>& blob, const T& value) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(&value);
  blob.insert(blob.end(), bytes, bytes + sizeof value);
}

/// Reads from the front; false if too few bytes are left.
class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : left_(bytes) {}
  template <class T>
  bool get(T& value) {
    if (left_.size() < sizeof value) return false;
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return true;
  }
  bool get(std::span<const uint8_t>& bytes, uint64_t size) {
    if (left_.size() < size) return false;
    bytes = left_.first(static_cast<size_t>(size));
    left_ = left_.subspan(static_cast<size_t>(size));
    return true;
  }
  bool empty() const { return left_.empty(); }

 private:
  std::span<const uint8_t> left_;
};

struct Part {
  std::string name;
  std::span<const uint8_t> data;
};

std::optional<std::vector<Part>> parts_of(std::span<const uint8_t> blob, const Magic& magic) {
  if (blob.size() < sizeof magic + 16 || std::memcmp(blob.data(), magic, sizeof magic) != 0) return {};
  const auto body = blob.first(blob.size() - 8);
  uint64_t hash = 0;
  std::memcpy(&hash, blob.data() + body.size(), sizeof hash);
  if (hash != fnv1a(body)) return {};
  Reader reader(body.subspan(sizeof magic));
  uint32_t version = 0, count = 0;
  if (!reader.get(version) || version != kVersion || !reader.get(count)) return {};
  std::vector<Part> parts;
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t name_size = 0;
    uint64_t data_size = 0;
    std::span<const uint8_t> name, data;
    if (!reader.get(name_size) || !reader.get(data_size) || !reader.get(name, name_size) ||
        !reader.get(data, data_size))
      return {};
    parts.push_back({{name.begin(), name.end()}, data});
  }
  if (!reader.empty()) return {};
  return parts;
}

/// Writes what parts_of() reads.
class PartWriter {
 public:
  explicit PartWriter(const Magic& magic) : blob_(std::begin(magic), std::end(magic)) {
    put(blob_, kVersion);
    put(blob_, uint32_t{0});
  }
  void add(std::string_view name, std::span<const uint8_t> data) {
    if (data.empty()) return;
    put(blob_, static_cast<uint32_t>(name.size()));
    put(blob_, static_cast<uint64_t>(data.size()));
    blob_.insert(blob_.end(), name.begin(), name.end());
    blob_.insert(blob_.end(), data.begin(), data.end());
    ++count_;
  }
  bool empty() const { return count_ == 0; }
  std::vector<uint8_t> finish() {
    std::memcpy(blob_.data() + sizeof(Magic) + sizeof kVersion, &count_, sizeof count_);
    put(blob_, fnv1a(blob_));
    return std::move(blob_);
  }

 private:
  std::vector<uint8_t> blob_;
  uint32_t count_ = 0;
};

/// The first eight bytes of a plugin's map (odo_plugin.save_map); 0 if it has fewer.
uint64_t id_of(std::span<const uint8_t> map) {
  uint64_t id = 0;
  if (map.size() >= sizeof id) std::memcpy(&id, map.data(), sizeof id);
  return id;
}

}  // namespace

std::vector<uint8_t> save_state(const PluginRoster& roster, const Anchors& anchors) {
  PartWriter out(kStateMagic);
  const auto names = roster.state_names();
  const auto& plugins = roster.plugins();
  for (size_t i = 0; i < plugins.size(); ++i) out.add(names[i], plugins[i]->save());
  out.add(kAnchors, anchors.save());
  return out.finish();
}

Result<bool> load_state(std::span<const uint8_t> blob, const PluginRoster& roster, Anchors& anchors) {
  const auto parts = parts_of(blob, kStateMagic);
  if (!parts) return Failure{ODO_E_DATA, "the blob is not a saved state, or it is damaged"};
  std::string refused;
  const auto names = roster.state_names();
  const auto& plugins = roster.plugins();
  for (const Part& part : *parts)
    for (size_t i = 0; i < plugins.size(); ++i)
      if (names[i] == part.name && !plugins[i]->load(part.data)) refused += " " + plugins[i]->id();
  for (const Part& part : *parts)
    if (part.name == kAnchors && !anchors.load(part.data)) refused += " anchors";
  if (!refused.empty()) return Failure{ODO_PARTIAL, "saved state rejected by:" + refused};
  return true;
}

std::vector<uint8_t> save_maps(const PluginRoster& roster, const Anchors& anchors, const KeptPoses& poses) {
  PartWriter out(kMapMagic);
  const auto names = roster.state_names();
  const auto& plugins = roster.plugins();
  for (size_t i = 0; i < plugins.size(); ++i) {
    const auto map = plugins[i]->save_map();
    if (map.empty()) continue;
    out.add(names[i], map);
    const uint32_t source = plugins[i]->number();
    const uint64_t id = id_of(map);
    std::optional<Rigid> T_n_m;  // nothing: a loaded map that was not recognised
    if (KeptPose frame; poses.kept_pose(poses.map_frame(source, id), frame))
      T_n_m = Rigid{frame.q_n_b, frame.p_n_b};
    else if (!plugins[i]->has_loaded(id))
      T_n_m = Rigid();  // a map of this session is in n
    out.add(std::string(kAnchors) + " " + names[i], anchors.save_in(T_n_m, source, id));
  }
  return out.empty() ? std::vector<uint8_t>() : out.finish();
}

Result<bool> load_maps(std::span<const uint8_t> blob, const PluginRoster& roster, Anchors& anchors) {
  const auto parts = parts_of(blob, kMapMagic);
  if (!parts) return Failure{ODO_E_DATA, "the data is not a map that this version reads, or it is damaged"};
  const auto names = roster.state_names();
  const auto plugin_of = [&](const Part& part) {
    return static_cast<size_t>(std::find(names.begin(), names.end(), part.name) - names.begin());
  };
  const Failure no_anchors{ODO_E_DATA, "the anchors of a map are damaged, or too many"};
  // What can be refused before anything changes.
  size_t count = anchors.ids().size();
  for (const Part& part : *parts) {
    const auto saved = part.name.starts_with(kAnchors) ? saved_anchors_of(part.data) : std::vector<SavedAnchor>();
    if (!saved || (count += saved->size()) > Anchors::Parameters().max_anchors) return no_anchors;
    if (!part.name.starts_with(kAnchors) && plugin_of(part) == names.size())
      return Failure{ODO_E_DATA, "a map of " + part.name + ", which this config does not have"};
  }
  for (const Part& part : *parts) {
    if (part.name.starts_with(kAnchors)) continue;
    const auto& plugin = roster.plugins()[plugin_of(part)];
    if (!plugin->load_map(part.data))
      return Failure{ODO_E_DATA, "a map was rejected by " + plugin->id() + ": it is damaged or of a later format"};
    for (const Part& other : *parts)
      if (other.name == std::string(kAnchors) + " " + part.name &&
          !anchors.load_in(other.data, plugin->number(), id_of(part.data)))
        return no_anchors;
  }
  return true;
}

}  // namespace odograph
