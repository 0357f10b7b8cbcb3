// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plugins/fix/skyline/city_outline.hpp"

namespace odograph::skyline {

/// Whether a text starts like XML.
bool is_xml(std::string_view text);

/// The buildings and the ground of a CityGML document (1.0 to 3.0; of each object the finest level of detail that has
/// surfaces). Elements are matched by their local names, independent of the version's namespaces; surfaces are read
/// where they are defined, not where a solid refers to them; implicit geometries are placed by their reference points
/// and matrices; surfaces in two dimensions are passed over. Throws std::runtime_error with file and line.
std::vector<Edge> parse_city_gml(const std::string& text, const std::string& name, const CityPlacement& placement,
                                 Georeference* georeference = nullptr);

}  // namespace odograph::skyline
