// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace odograph {

/// A value that one thread writes and any thread reads without a lock: two copies and a sequence number. A reader takes
/// the copy that is not being written, and retries only if the writer reached it meanwhile (seqlock with a latch;
/// Boehm, "Can seqlocks get along with programming language memory models?", 2012). One writer at a time.
template <class T>
class Snapshot {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(uint64_t) == 0);

 public:
  void write(const T& value) {
    std::array<uint64_t, kWords> words;
    std::memcpy(words.data(), &value, sizeof value);
    const uint64_t next = sequence_.load(std::memory_order_relaxed) + 1;
    auto& copy = copies_[next & 1];
    for (size_t i = 0; i < kWords; ++i) copy[i].store(words[i], std::memory_order_release);
    sequence_.store(next, std::memory_order_release);
  }

  T read() const {
    std::array<uint64_t, kWords> words;
    for (;;) {
      const uint64_t before = sequence_.load(std::memory_order_acquire);
      for (size_t i = 0; i < kWords; ++i) words[i] = copies_[before & 1][i].load(std::memory_order_acquire);
      if (sequence_.load(std::memory_order_relaxed) == before) break;
    }
    T value;
    std::memcpy(static_cast<void*>(&value), words.data(), sizeof value);
    return value;
  }

 private:
  static constexpr size_t kWords = sizeof(T) / sizeof(uint64_t);
  std::array<std::array<std::atomic<uint64_t>, kWords>, 2> copies_{};
  std::atomic<uint64_t> sequence_{0};
};

}  // namespace odograph
