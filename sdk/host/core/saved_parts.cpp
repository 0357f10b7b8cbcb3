// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/saved_parts.hpp"

#include <bit>
#include <cstring>

namespace odograph {
namespace {

static_assert(std::endian::native == std::endian::little, "the blob is written as the machine has its numbers");

constexpr char kMagic[2][8] = {{'O', 'D', 'O', 'S', 'T', 'A', 'T', 'E'}, {'O', 'D', 'O', 'M', 'A', 'P', 0, 0}};
constexpr uint32_t kVersion = 1;  // of both

const auto& magic_of(SavedKind kind) { return kMagic[kind == SavedKind::map ? 1 : 0]; }

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

}  // namespace

std::optional<std::vector<SavedPart>> parts_of(std::span<const uint8_t> blob, SavedKind kind) {
  const auto& magic = magic_of(kind);
  if (blob.size() < sizeof magic + 16 || std::memcmp(blob.data(), magic, sizeof magic) != 0) return {};
  const auto body = blob.first(blob.size() - 8);
  uint64_t hash = 0;
  std::memcpy(&hash, blob.data() + body.size(), sizeof hash);
  if (hash != fnv1a(body)) return {};
  Reader reader(body.subspan(sizeof magic));
  uint32_t version = 0, count = 0;
  if (!reader.get(version) || version != kVersion || !reader.get(count)) return {};
  std::vector<SavedPart> parts;
  constexpr uint32_t kMostParts = 1024;  // plugins with their maps; readers compare each with each
  if (count > kMostParts) return {};
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

PartWriter::PartWriter(SavedKind kind) : blob_(std::begin(magic_of(kind)), std::end(magic_of(kind))) {
  put(blob_, kVersion);
  put(blob_, uint32_t{0});
}

void PartWriter::add(std::string_view name, std::span<const uint8_t> data) {
  if (data.empty()) return;
  put(blob_, static_cast<uint32_t>(name.size()));
  put(blob_, static_cast<uint64_t>(data.size()));
  blob_.insert(blob_.end(), name.begin(), name.end());
  blob_.insert(blob_.end(), data.begin(), data.end());
  ++count_;
}

std::vector<uint8_t> PartWriter::finish() {
  std::memcpy(blob_.data() + sizeof kMagic[0] + sizeof kVersion, &count_, sizeof count_);
  put(blob_, fnv1a(blob_));
  return std::move(blob_);
}

uint64_t SavedMap::id() const {
  uint64_t id = 0;
  if (data.size() >= sizeof id) std::memcpy(&id, data.data(), sizeof id);
  return id;
}

Result<std::vector<SavedMap>> maps_of(std::span<const uint8_t> blob) {
  const auto parts = parts_of(blob, SavedKind::map);
  if (!parts) return Failure{ODO_E_DATA, "the data is not a map that this version reads, or it is damaged"};
  std::vector<SavedMap> maps;
  for (const SavedPart& part : *parts) {
    if (part.name.starts_with(kAnchorsPart)) continue;
    SavedMap& map = maps.emplace_back(SavedMap{part.name, part.data, {}});
    for (const SavedPart& other : *parts)
      if (other.name == std::string(kAnchorsPart) + " " + part.name) map.anchors = other.data;
  }
  return maps;
}

std::vector<uint8_t> bytes_of(std::span<const SavedMap> maps) {
  PartWriter out(SavedKind::map);
  for (const SavedMap& map : maps) {
    out.add(map.plugin, map.data);
    out.add(std::string(kAnchorsPart) + " " + map.plugin, map.anchors);
  }
  return out.empty() ? std::vector<uint8_t>() : out.finish();
}

Failure refused_map(const std::string& plugin) {
  return {ODO_E_DATA, "a map was rejected by " + plugin + ": it is damaged or of a later format"};
}

}  // namespace odograph
