// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/map_section.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <optional>

namespace odograph::place_map {
namespace {

constexpr char kMagic[8] = {'O', 'D', 'O', 'P', 'L', 'A', 'C', 'E'};
constexpr uint32_t kVersion = 1, kPattern = 1;
constexpr size_t kKeyFrame_bytes = 8 + 4 + 8 + 12 * 8 + 4, kLandmark_bytes = 8 + 5 * 4 + 2;
constexpr uint64_t kMost_landmarks = 10000;
constexpr double kFarthest_m = 1e7, kLargest_sigma = 1e4;
constexpr int kMost_levels = 32;

/// CRC-32 of IEEE 802.3.
uint32_t checksum(std::span<const uint8_t> bytes) {
  static const std::array<uint32_t, 256> table = [] {
    std::array<uint32_t, 256> made{};
    for (uint32_t i = 0; i < 256; ++i) {
      uint32_t x = i;
      for (int bit = 0; bit < 8; ++bit) x = x & 1 ? 0xEDB88320u ^ x >> 1 : x >> 1;
      made[i] = x;
    }
    return made;
  }();
  uint32_t x = UINT32_MAX;
  for (const uint8_t byte : bytes) x = table[(x ^ byte) & 0xff] ^ x >> 8;
  return ~x;
}

class Writer {
 public:
  template <std::integral T>
  void put(T value) {
    const auto bits = static_cast<std::make_unsigned_t<T>>(value);
    for (size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<uint8_t>(bits >> (8 * i)));
  }
  void put(double value) { put(std::bit_cast<uint64_t>(value)); }
  void put(float value) { put(std::bit_cast<uint32_t>(value)); }
  void put(const Eigen::Vector3d& v) { put(v.x()), put(v.y()), put(v.z()); }

  std::vector<uint8_t> bytes;
};

/// Reads numbers; after the end, zeros, and is_short.
class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  template <std::integral T>
  T integer() {
    using Bits = std::make_unsigned_t<T>;
    Bits bits = 0;
    if (left() < sizeof(T)) return is_short = true, T{0};
    for (size_t i = 0; i < sizeof(T); ++i) bits = static_cast<Bits>(bits | static_cast<Bits>(bytes_[at_++]) << (8 * i));
    return static_cast<T>(bits);
  }
  double real() { return std::bit_cast<double>(integer<uint64_t>()); }
  float real32() { return std::bit_cast<float>(integer<uint32_t>()); }
  Eigen::Vector3d vector() {
    const double x = real(), y = real();
    return {x, y, real()};
  }
  size_t left() const { return bytes_.size() - at_; }

  bool is_short = false;

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
};

void put(const KeyFrame& frame, Writer& out) {
  out.put(frame.id), out.put(frame.epoch), out.put(frame.t_ns);
  const Eigen::Quaterniond& q = frame.T_m_k.q;
  out.put(q.w()), out.put(q.x()), out.put(q.y()), out.put(q.z());
  out.put(frame.T_m_k.p), out.put(frame.down_k);
  out.put(frame.tilt_sigma_rad), out.put(frame.scale_sigma);
  out.put(static_cast<uint32_t>(frame.landmarks.size()));
  for (const KeptLandmark& landmark : frame.landmarks) {
    out.put(landmark.id);
    for (const float x : landmark.p_k) out.put(x);
    out.put(landmark.across_sigma), out.put(landmark.along_sigma);
    for (const int8_t level : landmark.levels) out.put(level);
    for (size_t look = 0; look < 2; ++look)
      if (landmark.levels[look] >= 0)
        for (const uint64_t word : landmark.descriptors[look]) out.put(word);
  }
}

/// A fault of a landmark, or null.
const char* read(Reader& in, KeptLandmark& landmark) {
  landmark.id = in.integer<uint64_t>();
  for (float& x : landmark.p_k) x = in.real32();
  landmark.across_sigma = in.real32(), landmark.along_sigma = in.real32();
  for (int8_t& level : landmark.levels) level = in.integer<int8_t>();
  for (size_t look = 0; look < 2; ++look) {
    if (landmark.levels[look] < -1 || landmark.levels[look] >= kMost_levels) return "a level is out of range";
    if (landmark.levels[look] >= 0)
      for (uint64_t& word : landmark.descriptors[look]) word = in.integer<uint64_t>();
  }
  const Eigen::Vector3f p = Eigen::Vector3f::Map(landmark.p_k.data());
  if (!p.allFinite() || !(p.norm() > 1e-3f && static_cast<double>(p.norm()) < kFarthest_m))
    return "a landmark is nowhere";
  for (const float sigma : {landmark.across_sigma, landmark.along_sigma})
    if (!(sigma >= 0 && static_cast<double>(sigma) < kLargest_sigma)) return "a landmark's sigma is out of range";
  return in.is_short ? "ends within a landmark" : nullptr;
}

const char* read(Reader& in, KeyFrame& frame) {
  frame.id = in.integer<uint64_t>(), frame.epoch = in.integer<uint32_t>(), frame.t_ns = in.integer<int64_t>();
  const double w = in.real(), x = in.real(), y = in.real(), z = in.real();
  frame.T_m_k.q = Eigen::Quaterniond(w, x, y, z);
  frame.T_m_k.p = in.vector(), frame.down_k = in.vector();
  frame.tilt_sigma_rad = in.real(), frame.scale_sigma = in.real();
  const auto count = in.integer<uint32_t>();
  if (in.is_short) return "ends within a key frame";
  const auto is_unit = [](double norm) { return std::abs(norm - 1) < 1e-3; };
  if (!is_unit(frame.T_m_k.q.norm()) || !is_unit(frame.down_k.norm())) return "a direction is not of unit length";
  frame.T_m_k.q.normalize(), frame.down_k.normalize();
  if (!frame.T_m_k.p.allFinite() || !(frame.T_m_k.p.norm() < kFarthest_m)) return "a key frame is nowhere";
  if (!(frame.tilt_sigma_rad > 1e-6 && frame.tilt_sigma_rad < 10) ||
      !(frame.scale_sigma >= 0 && frame.scale_sigma < 10))
    return "a sigma is out of range";
  if (count > kMost_landmarks || count > in.left() / kLandmark_bytes) return "has more landmarks than bytes";
  frame.landmarks.resize(count);
  for (KeptLandmark& landmark : frame.landmarks)
    if (const char* fault = read(in, landmark)) return fault;
  return nullptr;
}

}  // namespace

std::vector<uint8_t> bytes_of(const PlaceMap& map) {
  Writer out;
  for (const char letter : kMagic) out.put(static_cast<uint8_t>(letter));
  out.put(kVersion), out.put(kPattern), out.put(static_cast<uint64_t>(map.key_frames().size()));
  for (const KeyFrame& frame : map.key_frames()) put(frame, out);
  out.put(checksum(out.bytes));
  return std::move(out.bytes);
}

std::variant<std::vector<KeyFrame>, std::string> key_frames_of(std::span<const uint8_t> bytes) {
  if (bytes.size() < 28 || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0) return "is not a map of places";
  const auto body = bytes.first(bytes.size() - 4);
  Reader end(bytes.last(4)), in(body.subspan(sizeof kMagic));
  const auto version = in.integer<uint32_t>(), pattern = in.integer<uint32_t>();
  if (version != kVersion || pattern != kPattern)
    return "has version " + std::to_string(version) + "." + std::to_string(pattern) + ", not " +
           std::to_string(kVersion) + "." + std::to_string(kPattern);
  if (end.integer<uint32_t>() != checksum(body)) return "is damaged: its checksum does not fit";
  const auto count = in.integer<uint64_t>();
  if (count > in.left() / kKeyFrame_bytes) return "has more key frames than bytes";
  std::vector<KeyFrame> frames(count);
  for (size_t i = 0; i < count; ++i) {
    if (const char* fault = read(in, frames[i])) return "key frame " + std::to_string(i) + ": " + fault;
    if (frames[i].id <= (i == 0 ? 0 : frames[i - 1].id)) return "the ids of key frames do not increase";
  }
  if (in.left() > 0) return "has bytes after its end";
  return frames;
}

}  // namespace odograph::place_map
