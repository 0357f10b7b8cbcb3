// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/map_file.hpp"

#include <algorithm>
#include <cmath>

#include <odograph/anchor.h>
#include <odograph/places.h>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/core/saved_anchor.hpp"
#include "sdk/host/core/saved_parts.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/replay/saved_files.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

std::span<const uint8_t> bytes_in(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

}  // namespace

/// The plugin with the map.
struct MapFile::Reader {
  std::string error;
  HostServices host{0, {}, [this](const Report& report) {
                      if (report.severity >= ODO_SEVERITY_ERROR) error = report.text;
                    }};
  std::unique_ptr<PluginInstance> plugin;
  const odo_places* table = nullptr;
  uint64_t views = 0;
};

MapFile::MapFile() : reader_(std::make_unique<Reader>()) {}
MapFile::MapFile(MapFile&&) noexcept = default;
MapFile& MapFile::operator=(MapFile&&) noexcept = default;
MapFile::~MapFile() = default;

Result<MapFile> MapFile::read(const std::string& path, const std::vector<std::filesystem::path>& plugins) {
  const auto in_file = [&](const Failure& failure) { return Failure{failure.status, path + ": " + failure.text}; };
  const auto blob = read_saved_bytes(kMapFile, path);
  if (!blob) return blob.failure();
  const auto maps = maps_of(bytes_in(*blob));
  if (!maps) return in_file(maps.failure());
  if (maps->size() != 1) return Failure{ODO_E_UNSUPPORTED, path + ": has maps of several plugins; expected one"};
  const SavedMap& map = maps->front();
  if (map.plugin.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-/# ") != std::string::npos ||
      map.plugin.starts_with('/'))  // a path would be opened
    return Failure{ODO_E_DATA, path + ": a map of a plugin whose name is none"};
  MapFile file;
  file.path_ = path, file.plugin_ = map.plugin.substr(0, map.plugin.find(" #"));
  auto config =
      read_pipeline_config("odograph: 1\nabsolute_fixers:\n  - plugin: " + file.plugin_ + "\n", path, plugins);
  if (!config) return Failure{ODO_E_DATA, path + ": a map of " + file.plugin_ + ", which is not there"};
  file.version_ = config->fixers.front().manifest.version;
  Reader& reader = *file.reader_;
  auto plugin = PluginInstance::make(config->fixers.front(), config->library_check, 1, reader.host);
  if (!plugin) return in_file(plugin.failure());
  reader.plugin = std::move(*plugin);
  reader.table = static_cast<const odo_places*>(reader.plugin->extension(ODO_EXTENSION_PLACES));
  if (!reader.table)
    return Failure{ODO_E_UNSUPPORTED,
                   path + ": a map of " + file.plugin_ + ", which does not provide " ODO_EXTENSION_PLACES};
  if (const auto opened = file.open(map.data); !opened) return in_file(opened.failure());
  const auto anchors = saved_anchors_of(map.anchors);
  if (!anchors) return Failure{ODO_E_DATA, path + ": the anchors of a map are damaged, or too many"};
  for (const SavedAnchor& a : *anchors) file.anchors_.push_back({a.name, quaternion(a.q), Vector3d(a.p), a.sigma_m});
  return file;
}

Result<bool> MapFile::open(std::span<const uint8_t> map) {
  const odo_places& table = *reader_->table;
  if (table.open(table.user, map.data(), map.size(), &reader_->views) != ODO_OK) {
    Failure refused = refused_map(plugin_);
    if (!reader_->error.empty()) refused.text += " (" + reader_->error + ")";
    return refused;
  }
  return read_views();
}

Result<bool> MapFile::read_views() {
  const odo_places& table = *reader_->table;
  views_.clear();
  for (uint64_t i = 0; i < reader_->views; ++i) {
    odo_place_view view{};
    view.struct_size = sizeof view;
    int32_t status = table.view(table.user, i, &view, nullptr);
    std::vector<Vector3d> landmarks(view.landmarks);
    if (status == ODO_OK && !landmarks.empty()) status = table.view(table.user, i, &view, landmarks.front().data());
    if (status != ODO_OK) return Failure{status, plugin_ + " does not show its key frames"};
    views_.push_back({quaternion(view.q_m_c), Vector3d(view.p_m_c), view.epoch, std::move(landmarks)});
  }
  return true;
}

Result<MapFile::Joint> MapFile::join(const MapFile& other) {
  if (other.plugin_ != plugin_)
    return Failure{ODO_E_UNSUPPORTED,
                   other.path_ + ": a map of " + other.plugin_ + ", and " + path_ + " of " + plugin_};
  const auto map = other.map_bytes();
  const odo_places& table = *reader_->table;
  odo_place_joint joint{};
  joint.struct_size = sizeof joint;
  const int32_t status = table.join(table.user, map.data(), map.size(), &joint);
  if (status == ODO_E_NOT_FOUND)
    return Failure{status, text("%s: not found in %s: of the %u key frames of both, %u are recognised in the other map "
                                "and %u of them agree; do both show the same place, from the same sides?",
                                other.path_.c_str(), path_.c_str(), joint.asked, joint.recognised, joint.agreeing)};
  if (status != ODO_OK) return Failure{status, other.path_ + ": " + reader_->error};
  Joint out{
      joint.asked, joint.recognised, joint.agreeing, quaternion(joint.q_m_o), Vector3d(joint.p_m_o), joint.sigma_m, {}};
  for (const Anchor& anchor : other.anchors_) {
    const auto same = [&](const Anchor& mine) { return mine.name == anchor.name; };
    if (!anchor.name.empty() && std::any_of(anchors_.begin(), anchors_.end(), same))
      out.doubled.push_back(anchor.name);
    else
      anchors_.push_back({anchor.name, out.q_m_o * anchor.q_m, out.q_m_o * anchor.p_m + out.p_m_o,
                          std::hypot(anchor.sigma_m, out.sigma_m)});
  }
  if (const auto opened = open(map_bytes()); !opened) return opened.failure();
  return out;
}

Result<bool> MapFile::thin(uint64_t most) {
  const odo_places& table = *reader_->table;
  const size_t apart = bytes().size() - map_bytes().size();  // anchors and what is around the map
  const int32_t status = table.thin(table.user, most - std::min<uint64_t>(most, apart));
  if (status != ODO_OK) return Failure{status, path_ + ": " + reader_->error};
  if (const auto opened = open(map_bytes()); !opened) return opened.failure();
  if (const size_t size = bytes().size(); size > most)
    return Failure{ODO_E_ARGUMENT, text("%s: a single key frame and the anchors are %.3f MB", path_.c_str(),
                                        1e-6 * static_cast<double>(size))};
  return true;
}

std::vector<uint8_t> MapFile::map_bytes() const {
  const odo_places& table = *reader_->table;
  std::vector<uint8_t> map(static_cast<size_t>(std::max<int64_t>(0, table.save(table.user, nullptr, 0))));
  if (table.save(table.user, map.data(), map.size()) != static_cast<int64_t>(map.size())) map.clear();
  return map;
}

std::vector<uint8_t> MapFile::anchor_bytes() const {
  std::vector<uint8_t> bytes;
  for (const Anchor& anchor : anchors_) {
    SavedAnchor saved{};
    saved.kind = ODO_ANCHOR_POSE, saved.reference = kSavedNavigation, saved.sigma_m = anchor.sigma_m;
    anchor.name.copy(saved.name, sizeof saved.name - 1);
    put_quaternion(anchor.q_m, saved.q);
    Vector3d::Map(saved.p) = anchor.p_m;
    const auto* from = reinterpret_cast<const uint8_t*>(&saved);
    bytes.insert(bytes.end(), from, from + sizeof saved);
  }
  return bytes;
}

std::vector<uint8_t> MapFile::bytes() const {
  const auto map = map_bytes(), anchors = anchor_bytes();
  const SavedMap saved{plugin_, map, anchors};
  return map.empty() ? std::vector<uint8_t>() : bytes_of({&saved, 1});
}

Result<bool> MapFile::write(const std::string& path) const {
  const auto blob = bytes();
  if (blob.empty() || blob.size() > ODO_LARGEST_MAP)
    return Failure{ODO_E_EXHAUSTED, path +
                                        ": the map cannot be saved, or is larger than any session loads: make its "
                                        "parts smaller with `odograph map thin`"};
  return write_whole_file(path, {reinterpret_cast<const char*>(blob.data()), blob.size()});
}

}  // namespace odograph
