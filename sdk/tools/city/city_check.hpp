// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {

/// Summary of a city model's file.
struct CityCheck {
  std::string format;  ///< CityJSON, CityJSONSeq, CityJSONFeature, CityGML or OBJ
  std::string version, reference_system;
  size_t objects = 0, vertices = 0, surfaces = 0, holes = 0;
  std::map<std::string, size_t> skipped;  ///< number of geometries that are not supported, by type
  std::vector<std::string> warnings;
};

struct CityCheckLimits {
  uintmax_t file_bytes = 64u << 20;  ///< parsing takes 20 times as much memory: 1.3 GB
  double farthest_m = 1e8;           ///< from a reference system's origin: beyond any on Earth
  CrossingBudget crossings = {};     ///< of the edges of all surfaces, for triangulation
};

/// Reads and summarises a city model: CityJSON 1.0 to 2.0, CityJSONSeq (a line of CityJSON, then a CityJSONFeature per
/// line), a single CityJSONFeature, Wavefront OBJ. Of CityGML only the format is recognised: fix/skyline reads it.
/// Every failure names file, object and what was expected, without a library's message. Only regular files within the
/// size limit are opened. Thread: any.
Result<CityCheck> check_city_model(const std::filesystem::path& file, const CityCheckLimits& limits = {});
/// The same for a text; `name` replaces the file in messages.
Result<CityCheck> check_city_text(const std::string& text, const std::string& name, const CityCheckLimits& limits = {});

}  // namespace odograph
