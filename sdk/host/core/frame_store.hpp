// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include <odograph/types.h>

namespace odograph {

class SharedPixels;

/// Holds the borrowed messages (camera frames above all) that wait in the queue or that plugins retain, within a quota.
/// The memory stays the app's when the message can be retained; otherwise a frame's pixels are copied once on arrival.
/// With memory that the processes of plugins see they are always copied, into that memory, and no process needs a copy
/// of its own. Retain and release may be called on any thread; the app's own release is called without a lock. Must
/// outlive every message it handed out.
class FrameStore {
 public:
  /// `shared` may be null and outlives the store.
  explicit FrameStore(size_t quota, SharedPixels* shared = nullptr);
  ~FrameStore();
  FrameStore(const FrameStore&) = delete;
  FrameStore& operator=(const FrameStore&) = delete;

  /// Replaces the app's loan by the store's, in a borrowed message that is as large as the host's struct. The caller
  /// owns one hold and gives it up with release. ODO_E_EXHAUSTED when the quota is used up or the app refuses,
  /// ODO_E_DISCARD when a row is longer than its stride, ODO_E_UNSUPPORTED when it must be copied and cannot be (no
  /// pixels, no rows of an unknown format, no frame); the message has no loan then.
  int32_t adopt(odo_borrowed& message);
  /// Frames held now.
  size_t in_use() const;

 private:
  struct Holder {
    FrameStore* store = nullptr;
    std::atomic<int> holds{0};
    odo_loan original{};  // the app's
    bool copied = false;
    std::vector<uint8_t> pixels;
    std::span<uint8_t> shared;  // instead of them
  };

  std::span<uint8_t> memory_of(Holder& holder, size_t bytes);
  int32_t copy_frame(Holder& holder, odo_frame& frame);

  static int32_t ODO_CALL retain(void* owner);
  static void ODO_CALL release(void* owner);
  static const void* ODO_CALL native(void* owner, const char* id, uint64_t id_size);

  SharedPixels* shared_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Holder>> holders_;
};

}  // namespace odograph
