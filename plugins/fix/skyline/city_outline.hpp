// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace odograph::skyline {

/// An edge of a building in n (north, east, down; m), and its owner.
struct Edge {
  static constexpr int kUnknown = -1, kGround = -2;
  Eigen::Vector3d from, to;
  int object = kUnknown;  ///< from 0: a building of the model or a part of one; kGround: terrain, roads, water
  int also = kUnknown;    ///< second owner: adjacent walls, and terrain and building, share edges
};

/// The edges of a city model's buildings. Seen from below, the skyline consists of edges only: no point of a plane
/// polygon is higher than its border. `objects`: the owner of each ring; a shared edge has the first two owners.
std::vector<Edge> edges_of(const std::vector<std::vector<Eigen::Vector3d>>& rings,
                           const std::vector<int>& objects = {});

/// Position of n in a city model.
struct CityPlacement {
  std::array<double, 3> model_origin = {0, 0, 0};  ///< easting, northing and height of n's origin in the file, m
  bool geodetic = false;                           ///< geodetic_origin replaces model_origin, n's north is true north
  std::array<double, 3> geodetic_origin = {0, 0, 0};  ///< latitude and longitude in degrees, ellipsoidal height in m
  double geoid_height_m = 0;                          ///< ellipsoidal height of the file's zero height
};

/// How a model's coordinates became n's, where a geodetic origin asks for it.
struct Georeference {
  std::string description;  ///< reference system, transformation and accuracy; empty without a geodetic origin
  double accuracy_m = 0;    ///< of the transformation to WGS 84, as published
};

/// Reads the buildings of a CityJSON file (1.0 to 2.0, also CityJSONSeq; the finest level of detail) or a CityGML
/// document. Throws std::runtime_error with file and object, also where the reference system does not suit the
/// placement.
std::vector<Edge> read_city_outline(const std::string& file, const CityPlacement& placement,
                                    Georeference* georeference = nullptr);
/// The same from text; `name` replaces the file in messages.
std::vector<Edge> parse_city_outline(const std::string& text, const std::string& name, const CityPlacement& placement,
                                     Georeference* georeference = nullptr);

}  // namespace odograph::skyline
