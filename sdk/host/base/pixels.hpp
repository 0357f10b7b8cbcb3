// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <odograph/types.h>

namespace odograph {

/// Bytes of a frame's pixels and mask without gaps between rows.
size_t pixel_bytes(const odo_frame& frame);
/// Copies them to `memory`, which has as many, and lets the frame's planes point there. False, and the frame unusable,
/// when a plane is missing or a row is longer than its stride.
bool copy_pixels(odo_frame& frame, std::span<uint8_t> memory);

}  // namespace odograph
