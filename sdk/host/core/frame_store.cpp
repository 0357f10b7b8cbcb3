// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/frame_store.hpp"

#include <algorithm>

#include "sdk/host/base/pixels.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/shared_pixels.hpp"

namespace odograph {

FrameStore::FrameStore(size_t quota, SharedPixels* shared) : shared_(shared) {
  for (size_t i = 0; i < quota; ++i) {
    holders_.push_back(std::make_unique<Holder>());
    holders_.back()->store = this;
  }
}

FrameStore::~FrameStore() {
  for (const auto& holder : holders_)  // a plugin that kept a frame beyond its life: the app gets its pixels back
    if (holder->holds > 0 && !holder->copied && holder->original.release) holder->original.release(&holder->original);
  for (const auto& holder : holders_)
    if (shared_) shared_->give_back(holder->shared);
}

size_t FrameStore::in_use() const {
  const std::lock_guard lock(mutex_);
  return static_cast<size_t>(
      std::count_if(holders_.begin(), holders_.end(), [](const auto& h) { return h->holds > 0; }));
}

int32_t FrameStore::adopt(odo_frame& frame) {
  Holder* holder = nullptr;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& candidate : holders_)
      if (candidate->holds == 0) {
        holder = candidate.get();
        holder->holds = 1;
        break;
      }
  }
  if (!holder) return ODO_E_EXHAUSTED;
  holder->original = copy_as<odo_frame>(frame.header);
  holder->copied = shared_ || !(frame.retain && frame.release);
  const bool kept = holder->copied ? copy_pixels(frame, memory_of(*holder, pixel_bytes(frame)))
                                   : frame.retain(&holder->original) >= 0;
  if (!kept) {
    frame.release = nullptr;
    const int32_t status = holder->copied ? ODO_E_DISCARD : ODO_E_EXHAUSTED;
    holder->holds = 0;
    return status;
  }
  frame.owner = holder;
  frame.retain = retain;
  frame.release = release;
  return ODO_OK;
}

/// Kept from frame to frame.
std::span<uint8_t> FrameStore::memory_of(Holder& holder, size_t bytes) {
  if (shared_ && holder.shared.size() < bytes) {
    shared_->give_back(holder.shared);
    holder.shared = shared_->take(bytes);
  }
  if (shared_ && !holder.shared.empty()) return holder.shared.first(bytes);
  holder.pixels.resize(bytes);
  return holder.pixels;
}

int32_t FrameStore::retain(const odo_frame* frame) {
  auto* holder = static_cast<Holder*>(frame->owner);
  // One place stays free for the next frame: plugins may keep the rest.
  if (holder->holds == 1 && holder->store->in_use() >= holder->store->holders_.size()) return ODO_E_EXHAUSTED;
  ++holder->holds;
  return ODO_OK;
}

void FrameStore::release(const odo_frame* frame) {
  auto* holder = static_cast<Holder*>(frame->owner);
  const odo_frame original = holder->original;  // with the last hold the place may be taken again
  const bool give_back = !holder->copied;
  if (--holder->holds == 0 && give_back) original.release(&original);  // the app's code: no lock is held
}

}  // namespace odograph
