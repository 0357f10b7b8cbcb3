// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/pixels.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace odograph {
namespace {

/// For a plane of unknown format: 16,384 pixels of 16 bytes, the largest picture accepted.
constexpr uint32_t kMaxRows = 16384;
constexpr size_t kMaxRowBytes = 16384 * 16;

/// Rows and bytes per row of each plane, by format; zero rows mean no such plane.
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
    case ODO_FORMAT_YUV420:  // the pixel stride determines the row length of planes 1 and 2
      if (plane == 1 || plane == 2) {
        const size_t stride = std::max<size_t>(frame.planes[plane].pixel_stride, 1);
        return {(h + 1) / 2, ((w + 1) / 2 - 1) * stride + 1};
      }
      return plane == 0 ? PlaneSize{h, w} : PlaneSize{0, 0};
    case ODO_FORMAT_RGBA8:
    case ODO_FORMAT_BGRA8: return plane == 0 ? PlaneSize{h, w * 4} : PlaneSize{0, 0};
    default: {  // an unknown format, from a newer app: by its planes
      const odo_plane& p = frame.planes[plane];
      const bool used = static_cast<uint32_t>(plane) < frame.plane_count && p.rows <= kMaxRows;
      const auto bytes = static_cast<size_t>(std::llabs(p.row_stride));
      return used && bytes <= kMaxRowBytes ? PlaneSize{p.rows, bytes} : PlaneSize{0, 0};
    }
  }
}

}  // namespace

size_t pixel_bytes(const odo_frame& frame) {
  size_t total = 0;
  for (int p = 0; p < 4; ++p) total += plane_size(frame, p).rows * plane_size(frame, p).bytes;
  const bool masked = (frame.header.flags & ODO_FRAME_MASK) != 0 && frame.mask.data;
  return total + (masked ? size_t(frame.width) * frame.height : 0);
}

bool copy_pixels(odo_frame& frame, std::span<uint8_t> memory) {
  const bool masked = (frame.header.flags & ODO_FRAME_MASK) != 0 && frame.mask.data;
  uint8_t* to = memory.data();
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

}  // namespace odograph
