// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {

/// What a city model's file holds, without making anything of it.
struct CityCheck {
  std::string format;  ///< CityJSON, CityJSONSeq, CityJSONFeature or OBJ
  std::string version, reference_system;
  size_t objects = 0, vertices = 0, surfaces = 0, holes = 0;
  std::map<std::string, size_t> skipped;  ///< geometries that no reader here makes anything of, by type
  std::vector<std::string> warnings;
};

struct CityCheckLimits {
  uintmax_t file_bytes = 64u << 20;  ///< parsed in 20 times as much memory: 1.3 GB
  double farthest_m = 1e8;           ///< from a reference system's zero: beyond any on Earth
  CrossingBudget crossings = {};     ///< of the edges of all surfaces, which are to be cut into triangles
};

/// Reads a city model and says what is in it: CityJSON 1.0 to 2.0, CityJSONSeq (a CityJSON line, then a
/// CityJSONFeature a line), a single CityJSONFeature, Wavefront OBJ. Every failure says file, object and what was
/// expected: no library's own words. Only regular files are opened, and none beyond the limit. Thread: any.
Result<CityCheck> check_city_model(const std::filesystem::path& file, const CityCheckLimits& limits = {});
/// The same of a text; `name` stands for the file.
Result<CityCheck> check_city_text(const std::string& text, const std::string& name, const CityCheckLimits& limits = {});

}  // namespace odograph
