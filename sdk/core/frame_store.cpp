// SPDX-License-Identifier: Apache-2.0
#include "sdk/core/frame_store.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "sdk/core/messages.hpp"

namespace odograph {
namespace {

/// Rows and bytes a row of each plane, by format; zero rows = no such plane.
struct PlaneSize {
  size_t rows, bytes;
};
PlaneSize plane_size(const odo_frame& frame, int plane) {
  const size_t w = frame.width, h = frame.height;
  switch (frame.format) {
    case ODO_FORMAT_NV12:
    case ODO_FORMAT_NV21:
      if (plane == 1) return {(h + 1) / 2, (w + 1) / 2 * 2};
      [[fallthrough]];
    case ODO_FORMAT_GREY8: return plane == 0 ? PlaneSize{h, w} : PlaneSize{0, 0};
    case ODO_FORMAT_RGB8: return plane == 0 ? PlaneSize{h, w * 3} : PlaneSize{0, 0};
    case ODO_FORMAT_YUV420:  // planes 1 and 2 lie as far apart as their pixel stride says
      if (plane == 1 || plane == 2) {
        const size_t stride = std::max<size_t>(frame.planes[plane].pixel_stride, 1);
        return {(h + 1) / 2, ((w + 1) / 2 - 1) * stride + 1};
      }
      return plane == 0 ? PlaneSize{h, w} : PlaneSize{0, 0};
    default: return plane == 0 ? PlaneSize{h, w * 4} : PlaneSize{0, 0};
  }
}

}  // namespace

size_t pixel_bytes(const odo_frame& frame) {
  size_t total = 0;
  for (int p = 0; p < 4; ++p) total += plane_size(frame, p).rows * plane_size(frame, p).bytes;
  const bool masked = (frame.header.flags & ODO_FRAME_MASK) != 0 && frame.mask.data;
  return total + (masked ? size_t(frame.width) * frame.height : 0);
}

bool copy_pixels(odo_frame& frame, std::span<uint8_t> room) {
  const bool masked = (frame.header.flags & ODO_FRAME_MASK) != 0 && frame.mask.data;
  uint8_t* to = room.data();
  const auto copy = [&](odo_plane& plane, PlaneSize size) {
    if (static_cast<size_t>(std::llabs(plane.row_stride)) < size.bytes) return false;
    for (size_t row = 0; row < size.rows; ++row)
      std::memcpy(to + row * size.bytes, plane.data + static_cast<int64_t>(row) * plane.row_stride, size.bytes);
    plane.data = to;
    plane.row_stride = static_cast<int64_t>(size.bytes);
    to += size.rows * size.bytes;
    return true;
  };
  for (int p = 0; p < 4; ++p) {
    const PlaneSize size = plane_size(frame, p);
    if (size.rows == 0) continue;
    if (!frame.planes[p].data || !copy(frame.planes[p], size)) return false;
  }
  return !masked || copy(frame.mask, {frame.height, frame.width});
}

namespace {
bool copy_into(odo_frame& frame, std::vector<uint8_t>& pixels) {
  pixels.resize(pixel_bytes(frame));
  return copy_pixels(frame, pixels);
}
}  // namespace

FrameStore::FrameStore(size_t quota) {
  for (size_t i = 0; i < quota; ++i) {
    holders_.push_back(std::make_unique<Holder>());
    holders_.back()->store = this;
  }
}

FrameStore::~FrameStore() {
  for (const auto& holder : holders_)  // a plugin that kept a frame beyond its life: the app gets its pixels back
    if (holder->holds > 0 && !holder->copied && holder->original.release) holder->original.release(&holder->original);
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
  holder->copied = !(frame.retain && frame.release);
  const bool kept = holder->copied ? copy_into(frame, holder->pixels) : frame.retain(&holder->original) >= 0;
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
