// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "plugins/fix/terrain/terrain.hpp"

namespace odograph::terrain {

/// Reads one band of heights with columns to the east and rows to the south (ModelPixelScale and ModelTiepoint, OGC
/// 19-008r4). Rejects rotated grids. Throws std::runtime_error with the file's name.
Terrain read_geotiff(const std::string& file);

}  // namespace odograph::terrain
