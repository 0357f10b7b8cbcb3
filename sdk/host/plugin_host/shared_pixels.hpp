// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace odograph {

/// Memory for pixels, which the processes of plugins see and cannot change. It begins empty, takes system memory with
/// its first place, and grows up to kBytes. [any]
class SharedPixels {
 public:
  /// Of address space, in the host and in each process: eight pictures of 12 megapixels with four bytes each.
  static constexpr size_t kBytes = size_t(512) << 20;

  SharedPixels() = default;
  ~SharedPixels();
  SharedPixels(const SharedPixels&) = delete;
  SharedPixels& operator=(const SharedPixels&) = delete;

  /// The memory, for a process; -1, with errno, where the system has none that can be sealed against others' writing
  /// (EINVAL), or none now: the next call tries again.
  int descriptor();
  /// A place of at least so many bytes; empty where there is none.
  std::span<uint8_t> take(size_t bytes);
  /// An empty place is none.
  void give_back(std::span<uint8_t> place);
  /// Bytes of the memory that have ever been a place.
  size_t reserved() const;
  /// Where in the memory `at` is, if it is there.
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
  std::vector<Place> places_;  // in their order, without gaps
};

}  // namespace odograph
