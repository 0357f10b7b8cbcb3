// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace odograph::skyline {

/// An edge of a building in n (north, east, down; m), and whose it is.
struct Edge {
  static constexpr int kUnknown = -1, kGround = -2;
  Eigen::Vector3d from, to;
  int object = kUnknown;  ///< of the model, from 0 a building or a part of one; kGround: terrain, roads, water
  int also = kUnknown;    ///< whose else it is: walls that touch and the terrain around a foot share edges
};

/// The edges of a city model's buildings. Seen from below, the skyline runs along edges alone: within a plane polygon
/// nothing is higher than its border. `objects`: each ring's; an edge of several is the first one's, and also the
/// second one's.
std::vector<Edge> edges_of(const std::vector<std::vector<Eigen::Vector3d>>& rings,
                           const std::vector<int>& objects = {});

/// Where n lies in a city model.
struct CityPlacement {
  std::array<double, 3> model_origin = {0, 0, 0};  ///< easting, northing and height of n's origin in the file, m
  bool geodetic = false;  ///< geodetic_origin stands for model_origin, n's north is the true one
  std::array<double, 3> geodetic_origin = {0, 0, 0};  ///< latitude and longitude in degrees, ellipsoidal height in m
  double geoid_height_m = 0;                          ///< ellipsoidal height of the file's zero height
};

/// Reads the buildings of a CityJSON file (1.0 to 2.0, the finest level of detail). Throws std::runtime_error that
/// names file and object, and where a geodetic origin needs a reference system that is not known here.
std::vector<Edge> read_city_outline(const std::string& file, const CityPlacement& placement);
/// The same from text, `name` standing for the file in messages.
std::vector<Edge> parse_city_outline(const std::string& text, const std::string& name, const CityPlacement& placement);

}  // namespace odograph::skyline
