// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// A 3D city model as classified triangles, in n (north, east, down; m) about `origin`.
struct CityModel {
  enum class Kind { wall, roof, road, paved, green, water };
  struct Face {
    std::array<Eigen::Vector3d, 3> corners;
    Eigen::Vector3d normal;  ///< unit; out of a building, up from the ground
    Kind kind;
    uint32_t object;  ///< index in objects
  };
  struct Object {
    std::string id;
    bool is_building = false;
    double top_up_m = 0;  ///< of its highest corner
  };
  std::vector<Face> faces;
  std::vector<Object> objects;
  /// Easting, northing and height, in the file's own reference system, of n's origin.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d low, high;  ///< bounds in n
};

/// Reads CityJSON (1.0 to 2.0; of several levels of detail the finest that has surfaces) or Wavefront OBJ (x east, y
/// north, z up; groups whose names start with "terrain" or "ground" are ground). The default origin is the south-west
/// corner at the lowest height. Failures name the file and the city object.
Result<CityModel> read_city_model(const std::filesystem::path& file, std::optional<Eigen::Vector3d> origin = {});
/// Whether a text starts like XML: CityGML, which read_city_model does not support.
bool is_xml(std::string_view text);
/// The same from text; `name` replaces the file in messages.
Result<CityModel> parse_city_json(std::string_view text, const std::string& name,
                                  std::optional<Eigen::Vector3d> origin = {});

/// Limit of the triangulation's cost for a file: a sweep takes n log n for n edges (GLU), but adds a vertex at each
/// crossing of two edges.
struct CrossingBudget {
  uint64_t crossings = 100'000;  ///< of edges that are not adjacent: one second, and as many triangles
  uint64_t pairs = 500'000'000;  ///< of edges that are compared to find them: two seconds
};
/// Subtracts a polygon's crossings from the budget. False where it is exhausted. Thread: any.
bool spend_crossings(const std::vector<std::vector<Eigen::Vector3d>>& rings, CrossingBudget& budget);

/// Triangulates a polygon: the first ring is its border, the others are holes. Rings are planar up to survey errors and
/// may touch themselves. Thread: any.
std::vector<std::array<Eigen::Vector3d, 3>> triangulate(const std::vector<std::vector<Eigen::Vector3d>>& rings);
/// The normal of a ring by Newell's method: its length is twice the area.
Eigen::Vector3d newell_normal(const std::vector<Eigen::Vector3d>& ring);

/// One building of a generated town: a parallelogram's prism.
struct Building {
  std::array<Eigen::Vector3d, 4> foot;  ///< in n, in order around the foot
  double height_m = 0;
  bool surveyed = true;  ///< false: newer than the city model, which does not have it
};
/// A sign of known position and appearance: a tag of the family 36h11, or a poster.
struct KnownObject {
  uint32_t tag = 0;  ///< its number, also of a poster
  cv::Mat poster;    ///< 8-bit grey; empty: the sign shows the tag
  std::array<Eigen::Vector3d, 4>
      corners;  ///< in n: lower left, lower right, upper right, upper left as seen by a reader
};
/// Writes the surveyed part of a generated town as CityJSON 2.0: x east, y north, z up from n's origin; the buildings
/// that are surveyed as LoD1 solids, tags as CityFurniture with the attribute `tag36h11`.
Result<bool> write_city_json(const std::filesystem::path& file, const std::vector<Building>& buildings,
                             const std::vector<KnownObject>& objects);

}  // namespace odograph
