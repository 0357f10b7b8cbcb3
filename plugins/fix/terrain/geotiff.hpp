// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "plugins/fix/terrain/terrain.hpp"

namespace odograph::terrain {

inline constexpr uint32_t kMaxNodes = 100'000'000;  // of a grid

[[noreturn]] inline void refuse(const std::string& file, const std::string& why) {
  throw std::runtime_error(file + ": " + why);
}

/// Reads one band of heights with columns to the east and rows to the south (ModelPixelScale and ModelTiepoint, OGC
/// 19-008r4). Rejects rotated grids. Throws std::runtime_error with the file's name.
Terrain read_geotiff(const std::string& file);

}  // namespace odograph::terrain
