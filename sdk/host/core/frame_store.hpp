// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include <odograph/types.h>

namespace odograph {

class SharedPixels;

/// Holds borrowed messages (mainly camera frames) that wait in the queue or that plugins retain, within a quota. Memory
/// stays with the app if the message can be retained; otherwise the pixels are copied once on arrival. With memory
/// shared with plugin processes, pixels are always copied into it, so that no process needs its own copy. Retain and
/// release may be called on any thread; the app's own release is called without a lock. Must outlive every message it
/// returned.
class FrameStore {
 public:
  /// `shared` may be null and outlives the store.
  explicit FrameStore(size_t quota, SharedPixels* shared = nullptr);
  ~FrameStore();
  FrameStore(const FrameStore&) = delete;
  FrameStore& operator=(const FrameStore&) = delete;

  /// Replaces the app's loan with the store's, in a borrowed message of the host's struct size. The caller owns one
  /// reference and drops it with release. ODO_E_EXHAUSTED if the quota is used up or the app refuses, ODO_E_DISCARD if
  /// a row exceeds its stride, ODO_E_UNSUPPORTED if the message must be copied but cannot be (no pixels, unknown
  /// format, not a frame); the message then has no loan.
  int32_t adopt(odo_borrowed& message);
  /// Number of frames held.
  size_t in_use() const;

 private:
  struct Holder {
    FrameStore* store = nullptr;
    std::atomic<int> holds{0};
    odo_loan original{};  // the app's
    bool copied = false;
    std::vector<uint8_t> pixels;
    std::span<uint8_t> shared;  // used instead of own memory
  };

  std::span<uint8_t> memory_of(Holder& holder, size_t bytes);
  int32_t copy_frame(Holder& holder, odo_frame& frame);

  static int32_t ODO_CALL retain(void* owner);
  static void ODO_CALL release(void* owner);
  static const void* ODO_CALL native(void* owner, const char* id, uint64_t id_size);

  SharedPixels* shared_;
  std::vector<std::unique_ptr<Holder>> holders_;
};

}  // namespace odograph
