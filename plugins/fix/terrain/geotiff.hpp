// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "plugins/fix/terrain/terrain.hpp"

namespace odograph::terrain {

/// One band of heights whose columns run east and rows run south (ModelPixelScale and ModelTiepoint, OGC 19-008r4).
/// Rotated grids are refused. Throws std::runtime_error with the file's name.
Terrain read_geotiff(const std::string& file);

}  // namespace odograph::terrain
