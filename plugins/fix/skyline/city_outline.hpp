// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace odograph::skyline {

/// An edge of a building in n (north, east, down; m).
struct Edge {
  Eigen::Vector3d from, to;
};

/// The edges of a city model's buildings. Seen from below, the skyline runs along edges alone: within a plane polygon
/// nothing is higher than its border.
std::vector<Edge> edges_of(const std::vector<std::vector<Eigen::Vector3d>>& rings);

/// Reads the buildings of a CityJSON file (1.0 to 2.0, the finest level of detail). `origin` is n's origin as easting,
/// northing and height of the file's own reference system. Throws std::runtime_error that names file and object.
std::vector<Edge> read_city_outline(const std::string& file, const std::array<double, 3>& origin);
/// The same from text, `name` standing for the file in messages.
std::vector<Edge> parse_city_outline(const std::string& text, const std::string& name,
                                     const std::array<double, 3>& origin);

}  // namespace odograph::skyline
