// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/frame_store.hpp"

#include <algorithm>
#include <utility>

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
  for (const auto& holder : holders_)  // a plugin retained a frame beyond its lifetime: return the pixels to the app
    if (holder->holds > 0 && !holder->copied && holder->original.release)
      holder->original.release(holder->original.owner);
  for (const auto& holder : holders_)
    if (shared_) shared_->give_back(holder->shared);
}

size_t FrameStore::in_use() const {
  return static_cast<size_t>(
      std::count_if(holders_.begin(), holders_.end(), [](const auto& h) { return h->holds > 0; }));
}

int32_t FrameStore::adopt(odo_borrowed& message) {
  const auto free = std::find_if(holders_.begin(), holders_.end(), [](const auto& candidate) {
    int none = 0;
    return candidate->holds.compare_exchange_strong(none, 1);
  });
  if (free == holders_.end()) return message.loan = {}, ODO_E_EXHAUSTED;
  Holder* const holder = free->get();
  const auto give_back = [](Holder* unused) { unused->holds = 0; };  // also if memory runs out
  std::unique_ptr<Holder, decltype(give_back)> place(holder, give_back);
  const odo_loan original = std::exchange(message.loan, {});
  const bool can_be_retained = original.retain && original.release;
  const bool is_frame = message.header.type == ODO_TYPE_FRAME;
  const bool has_pixels = is_frame && reinterpret_cast<odo_frame&>(message).planes[0].data;
  holder->original = original;
  holder->copied = !can_be_retained || (shared_ && has_pixels);
  int32_t status = ODO_OK;
  if (!holder->copied)
    status = original.retain(original.owner) >= 0 ? ODO_OK : ODO_E_EXHAUSTED;
  else
    status = has_pixels ? copy_frame(*holder, reinterpret_cast<odo_frame&>(message)) : ODO_E_UNSUPPORTED;
  if (status < 0) return status;
  (void)place.release();
  message.loan = {holder, retain, release, !holder->copied && original.native ? native : nullptr, 0};
  return ODO_OK;
}

int32_t FrameStore::copy_frame(Holder& holder, odo_frame& frame) {
  const size_t bytes = pixel_bytes(frame);
  if (bytes == 0) return ODO_E_UNSUPPORTED;
  return copy_pixels(frame, memory_of(holder, bytes)) ? ODO_OK : ODO_E_DISCARD;
}

/// Reused from frame to frame.
std::span<uint8_t> FrameStore::memory_of(Holder& holder, size_t bytes) {
  if (shared_ && holder.shared.size() < bytes) {
    shared_->give_back(holder.shared);
    holder.shared = shared_->take(bytes);
  }
  if (shared_ && !holder.shared.empty()) return holder.shared.first(bytes);
  holder.pixels.resize(bytes);
  return holder.pixels;
}

int32_t FrameStore::retain(void* owner) {
  auto* holder = static_cast<Holder*>(owner);
  // Plugins may retain all frames but one, so that the next frame always has a slot.
  if (holder->holds == 1 && holder->store->in_use() >= holder->store->holders_.size()) return ODO_E_EXHAUSTED;
  ++holder->holds;
  return ODO_OK;
}

void FrameStore::release(void* owner) {
  auto* holder = static_cast<Holder*>(owner);
  const odo_loan original = holder->original;  // the slot may be reused after the last release
  const bool give_back = !holder->copied;
  if (--holder->holds == 0 && give_back) original.release(original.owner);  // the app's code: call it without a lock
}

const void* FrameStore::native(void* owner, const char* id, uint64_t id_size) {
  const odo_loan& original = static_cast<Holder*>(owner)->original;
  return original.native(original.owner, id, id_size);
}

}  // namespace odograph
