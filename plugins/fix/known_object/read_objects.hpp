// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "plugins/fix/known_object/plane_object.hpp"

namespace odograph::known_object {

/// Reads objects from GeoJSON (`*.json`, `*.geojson`; RFC 7946) or YAML, both as in the README, with their pictures
/// (PNG) in the same folder. At most 1 MiB of text, 1,000 objects and 16 million pixels per picture; no YAML aliases.
/// Throws std::runtime_error with the file and the object.
std::vector<PlaneObject> read_objects(const std::filesystem::path& file);

/// Reads a PNG file as an 8-bit grey picture. Throws std::runtime_error.
cv::Mat read_png(const std::filesystem::path& file);

}  // namespace odograph::known_object
