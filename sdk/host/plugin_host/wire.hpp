// SPDX-License-Identifier: Apache-2.0
//
// Protocol between host and plugin process through shared memory. Both come from the same build (kWireVersion), but the
// host does not trust what the plugin's process writes: it copies first, then checks.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace odograph::wire {

constexpr uint32_t kVersion = 8;
/// Fixed descriptors of the plugin's process.
constexpr int kSocket = 3, kControl = 4, kPixels = 5;

/// `enter` sandboxes the process and returns what the system lacks for it; `open` loads the library: no plugin code
/// runs before `open`.
enum Call : uint32_t { enter = 1, open, start, process, reset, save, load, save_map, load_map, end };
enum Record : uint32_t { event = 1, report = 2, state = 3 };

constexpr size_t kFrameSlots = 8;                // as many as a session holds by default
constexpr size_t kAreaBytes = size_t(20) << 20;  // 256 events of the largest size, or a saved state of 16 MiB
constexpr size_t kPhaseBytes = 32;

/// The control memory: a small state, then the request, then the answer.
struct Control {
  uint32_t version;
  uint32_t call;
  uint64_t request_size, response_size;
  std::atomic<uint32_t> holds[kFrameSlots];  // of each frame slot, held by the plugin
  char phase[kPhaseBytes];                   // the plugin function being called
  alignas(64) uint8_t request[kAreaBytes];
  alignas(64) uint8_t response[kAreaBytes];
};

/// Appends numbers and texts; an item that does not fit is dropped and marks the writer full.
class Writer {
 public:
  explicit Writer(std::span<uint8_t> buffer) : buffer_(buffer) {}
  template <class T>
  void put(const T& value) {
    put_raw(&value, sizeof value);
  }
  void put_bytes(const void* data, uint64_t size) {
    if (sizeof size + size > buffer_.size() - at_) {
      full_ = true;
      return;
    }
    put(size);
    put_raw(data, static_cast<size_t>(size));
  }
  void put_text(std::string_view text) { put_bytes(text.data(), text.size()); }
  size_t size() const { return at_; }
  bool full() const { return full_; }
  void rewind(size_t to) { at_ = to; }

 private:
  void put_raw(const void* data, size_t size) {
    if (full_ || size > buffer_.size() - at_) {
      full_ = true;
      return;
    }
    if (size > 0) std::memcpy(buffer_.data() + at_, data, size);
    at_ += size;
  }
  std::span<uint8_t> buffer_;
  size_t at_ = 0;
  bool full_ = false;
};

/// Reads them from the front; missing items read as zero and mark the reader bad.
class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : left_(bytes) {}
  template <class T>
  T get() {
    T value{};
    if (left_.size() < sizeof value) {
      good_ = false;
      return value;
    }
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return value;
  }
  std::span<const uint8_t> get_bytes() {
    const auto size = get<uint64_t>();
    if (!good_ || size > left_.size()) {
      good_ = false;
      return {};
    }
    const auto bytes = left_.first(static_cast<size_t>(size));
    left_ = left_.subspan(static_cast<size_t>(size));
    return bytes;
  }
  std::string get_text() {
    const auto bytes = get_bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  bool good() const { return good_; }
  bool empty() const { return left_.empty(); }

 private:
  std::span<const uint8_t> left_;
  bool good_ = true;
};

}  // namespace odograph::wire
