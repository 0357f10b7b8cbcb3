// SPDX-License-Identifier: Apache-2.0
//
// The bytes of a map: a section of a file. Little endian, whatever the processor.
//
//   "ODOPLACE"  u32 version  u32 pattern  u64 key frames
//   of each:    u64 id  u32 epoch  i64 t_ns  f64 q_m_k[4] (w, x, y, z)  f64 p_m_k[3]  f64 down_k[3]
//               f64 tilt_sigma_rad  f64 scale_sigma  u32 landmarks
//   of each:    u64 id  f32 p_k[3]  f32 across_sigma  f32 along_sigma  i8 levels[2]
//               u64[4] for each level that is not -1
//   u32 CRC-32 of all that precedes it
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "plugins/fix/map/place_map.hpp"

namespace odograph::place_map {

std::vector<uint8_t> bytes_of(const PlaceMap& map);

/// The key frames of such bytes, or why they are none. Survives any input: lengths are checked before memory is
/// reserved, numbers are finite and in range.
std::variant<std::vector<KeyFrame>, std::string> key_frames_of(std::span<const uint8_t> bytes);

}  // namespace odograph::place_map
