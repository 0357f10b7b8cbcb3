// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace odograph {

/// Memory for pixels, readable but not writable by plugin processes. Allocated on first use; grows up to kBytes. [any]
class SharedPixels {
 public:
  /// Address space, in the host and in each process: eight pictures of 12 megapixels with four bytes each.
  static constexpr size_t kBytes = size_t(512) << 20;

  SharedPixels() = default;
  ~SharedPixels();
  SharedPixels(const SharedPixels&) = delete;
  SharedPixels& operator=(const SharedPixels&) = delete;

  /// Descriptor of the memory, for a process; -1, with errno, if the system cannot seal it against writing (EINVAL), or
  /// if allocation failed: the next call tries again.
  int descriptor();
  /// Allocates a block of at least that many bytes; empty on failure.
  std::span<uint8_t> take(size_t bytes);
  /// An empty block is ignored.
  void give_back(std::span<uint8_t> place);
  /// Bytes of the memory that have ever been allocated.
  size_t reserved() const;
  /// Offset of `at`, if it points into the memory.
  std::optional<uint64_t> offset_of(const uint8_t* at) const;

 private:
  struct Place {
    size_t offset, bytes;
    bool taken;
  };

  void open();

  std::mutex opening_;
  int fd_ = -1;
  uint8_t* memory_ = nullptr;
  mutable std::mutex mutex_;
  size_t size_ = 0;
  std::vector<Place> places_;  // in order, without gaps
};

}  // namespace odograph
