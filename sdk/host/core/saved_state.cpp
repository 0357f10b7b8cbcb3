// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/saved_state.hpp"

#include <bit>
#include <cstring>

namespace odograph {
namespace {

static_assert(std::endian::native == std::endian::little, "the blob is written as the machine has its numbers");

constexpr char kStateMagic[] = {'O', 'D', 'O', 'S', 'T', 'A', 'T', 'E'};
constexpr uint32_t kStateVersion = 1;
constexpr char kAnchors[] = "host anchors/1";  // the host's own part

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

std::optional<std::vector<Part>> parts_of(std::span<const uint8_t> blob) {
  if (blob.size() < sizeof kStateMagic + 16 || std::memcmp(blob.data(), kStateMagic, sizeof kStateMagic) != 0)
    return {};
  const auto body = blob.first(blob.size() - 8);
  uint64_t hash = 0;
  std::memcpy(&hash, blob.data() + body.size(), sizeof hash);
  if (hash != fnv1a(body)) return {};
  Reader reader(body.subspan(sizeof kStateMagic));
  uint32_t version = 0, count = 0;
  if (!reader.get(version) || version != kStateVersion || !reader.get(count)) return {};
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

}  // namespace

std::vector<uint8_t> save_state(const PluginRoster& roster, const Anchors& anchors) {
  std::vector<uint8_t> parts, blob(std::begin(kStateMagic), std::end(kStateMagic));
  uint32_t count = 0;
  const auto names = roster.state_names();
  const auto& plugins = roster.plugins();
  for (size_t i = 0; i < plugins.size(); ++i) {
    const auto data = plugins[i]->save();
    if (data.empty()) continue;
    const std::string& name = names[i];
    put(parts, static_cast<uint32_t>(name.size()));
    put(parts, static_cast<uint64_t>(data.size()));
    parts.insert(parts.end(), name.begin(), name.end());
    parts.insert(parts.end(), data.begin(), data.end());
    ++count;
  }
  if (const auto saved = anchors.save(); !saved.empty()) {
    put(parts, static_cast<uint32_t>(sizeof kAnchors - 1));
    put(parts, static_cast<uint64_t>(saved.size()));
    parts.insert(parts.end(), kAnchors, kAnchors + sizeof kAnchors - 1);
    parts.insert(parts.end(), saved.begin(), saved.end());
    ++count;
  }
  put(blob, kStateVersion);
  put(blob, count);
  blob.insert(blob.end(), parts.begin(), parts.end());
  put(blob, fnv1a(blob));
  return blob;
}

Result<bool> load_state(std::span<const uint8_t> blob, const PluginRoster& roster, Anchors& anchors) {
  const auto parts = parts_of(blob);
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

}  // namespace odograph
