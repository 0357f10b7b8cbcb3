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

/// Holds the camera frames that wait in the queue or that plugins keep, within a quota. The pixels stay the app's when
/// the app's frame can be retained; otherwise they are copied once on arrival. With memory that the processes of
/// plugins see they are always copied, into that memory, and no process needs a copy of its own. Retain and release may
/// be called on any thread; the app's own release is called without a lock. Must outlive every frame it handed out.
class FrameStore {
 public:
  /// `shared` may be null and outlives the store.
  explicit FrameStore(size_t quota, SharedPixels* shared = nullptr);
  ~FrameStore();
  FrameStore(const FrameStore&) = delete;
  FrameStore& operator=(const FrameStore&) = delete;

  /// Replaces the app's hold functions by the store's, in a message that is as large as the host's struct. The caller
  /// owns one hold and gives it up with release. ODO_E_EXHAUSTED when the quota is used up or the app refuses,
  /// ODO_E_DISCARD when a row is longer than its stride; the frame has no release then.
  int32_t adopt(odo_frame& frame);
  /// Frames held now.
  size_t in_use() const;

 private:
  struct Holder {
    FrameStore* store = nullptr;
    std::atomic<int> holds{0};
    odo_frame original{};
    bool copied = false;
    std::vector<uint8_t> pixels;
    std::span<uint8_t> shared;  // instead of them
  };

  std::span<uint8_t> memory_of(Holder& holder, size_t bytes);

  static int32_t retain(const odo_frame* frame);
  static void release(const odo_frame* frame);

  SharedPixels* shared_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Holder>> holders_;
};

}  // namespace odograph
