// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <odograph/types.h>

namespace odograph {

/// Size of a frame's pixels and mask in bytes, without gaps between rows.
size_t pixel_bytes(const odo_frame& frame);
/// Copies the pixels to `memory`, which must have that size, and redirects the frame's planes to it. False, and the
/// frame unusable, if a plane is missing or a row exceeds its stride.
bool copy_pixels(odo_frame& frame, std::span<uint8_t> memory);

}  // namespace odograph
