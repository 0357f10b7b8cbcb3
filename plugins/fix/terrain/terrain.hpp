// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace odograph::terrain {

/// Heights at the nodes of a regular grid, bilinear between them.
struct Grid {
  double east_m = 0, north_m = 0;  ///< of the node in the south-west
  double cell_east_m = 1, cell_north_m = 1;
  size_t columns = 0, rows = 0;
  std::vector<float> height_m;  ///< from the south to the north, each row from the west to the east; NaN: unknown
};

/// Triangles of a surface, indexed by a square grid.
class Mesh {
 public:
  /// Vertices (east, north, up; m) and their indices, three per triangle. Upright triangles are not ground and are
  /// dropped. Throws std::runtime_error for an index out of range, and if no triangle remains.
  Mesh(std::vector<Eigen::Vector3d> vertices, const std::vector<std::array<uint32_t, 3>>& triangles);
  /// Heights of all surfaces at a position, in no particular order.
  std::vector<double> heights_at(double east_m, double north_m) const;

 private:
  size_t cell_of(double value, double low) const;

  std::vector<Eigen::Vector3d> vertices_;
  std::vector<std::array<uint32_t, 3>> triangles_;
  std::vector<std::vector<uint32_t>> cells_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double cell_m_ = 1;
  size_t columns_ = 0, rows_ = 0;
};

/// Coordinate reference of a file, as far as the file gives it.
struct Reference {
  int epsg = 0;                           ///< 0: not given
  int vertical_epsg = 0;                  ///< 0: not given
  bool geographic = false;                ///< degrees instead of a projection's units
  double height_unit_m = 0;               ///< 0: not given
  std::array<double, 2> middle = {0, 0};  ///< of the model, in its coordinates
};

/// Height of the ground above the datum of a model. Immutable, thread-safe.
class Terrain {
 public:
  explicit Terrain(Grid grid, Reference reference = {}) : surface_(std::move(grid)), reference_(reference) {}
  explicit Terrain(Mesh mesh) : surface_(std::move(mesh)) {}
  /// Height at a position in the model's coordinates, m; of several surfaces (a bridge, a floor) the one nearest to
  /// `expected_m`. False if the model has no ground there.
  bool height_at(double east, double north, double expected_m, double& height_m) const;
  const Reference& reference() const { return reference_; }

 private:
  std::variant<Grid, Mesh> surface_;
  Reference reference_;
};

/// Format by the file extension: ESRI ASCII grid (.asc), Wavefront OBJ (.obj; x east, y north, z up), GeoTIFF (.tif,
/// .tiff; one band of integers or floats). Throws std::runtime_error with the file's name and the reason.
Terrain read_terrain(const std::string& file);

}  // namespace odograph::terrain
