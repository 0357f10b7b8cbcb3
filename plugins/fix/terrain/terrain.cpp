// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/terrain/terrain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace odograph::terrain {
namespace {

constexpr double kSteepest = 0.1;        // vertical component of a triangle's normal: steeper ones are walls
constexpr size_t kMaxCells = 1'000'000;  // of the mesh's search grid
constexpr double kEdge = 1e-9;           // tolerance at the edges, as a part of a triangle

bool height_of(const Grid& grid, double east_m, double north_m, double& height_m) {
  const double x = (east_m - grid.east_m) / grid.cell_east_m, y = (north_m - grid.north_m) / grid.cell_north_m;
  if (!(x >= 0 && y >= 0 && x <= static_cast<double>(grid.columns - 1) && y <= static_cast<double>(grid.rows - 1)))
    return false;
  const size_t i = std::min(static_cast<size_t>(x), grid.columns - 2),
               j = std::min(static_cast<size_t>(y), grid.rows - 2);
  const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
  const auto at = [&](size_t row, size_t column) {
    return static_cast<double>(grid.height_m[row * grid.columns + column]);
  };
  height_m = (1 - v) * ((1 - u) * at(j, i) + u * at(j, i + 1)) + v * ((1 - u) * at(j + 1, i) + u * at(j + 1, i + 1));
  return std::isfinite(height_m);
}

}  // namespace

Mesh::Mesh(std::vector<Eigen::Vector3d> vertices, const std::vector<std::array<uint32_t, 3>>& triangles)
    : vertices_(std::move(vertices)) {
  for (const auto& t : triangles) {
    for (const uint32_t index : t)
      if (index >= vertices_.size()) throw std::runtime_error("a face refers to a vertex that does not exist");
    const Eigen::Vector3d normal = (vertices_[t[1]] - vertices_[t[0]]).cross(vertices_[t[2]] - vertices_[t[0]]);
    if (std::abs(normal.z()) > kSteepest * normal.norm()) triangles_.push_back(t);
  }
  if (triangles_.empty()) throw std::runtime_error("no ground: all triangles are upright");
  Eigen::Vector2d high = low_ = vertices_[triangles_[0][0]].head<2>();
  for (const auto& t : triangles_)
    for (const uint32_t index : t) {
      low_ = low_.cwiseMin(vertices_[index].head<2>());
      high = high.cwiseMax(vertices_[index].head<2>());
    }
  const Eigen::Vector2d size = (high - low_).cwiseMax(1e-6);
  const double wanted = static_cast<double>(std::min(kMaxCells, triangles_.size()));
  cell_m_ = std::max(std::sqrt(size.x() * size.y() / wanted), size.maxCoeff() / 1000);
  columns_ = static_cast<size_t>(size.x() / cell_m_) + 1, rows_ = static_cast<size_t>(size.y() / cell_m_) + 1;
  cells_.resize(columns_ * rows_);
  for (uint32_t k = 0; k < triangles_.size(); ++k) {
    Eigen::Vector2d from = vertices_[triangles_[k][0]].head<2>(), to = from;
    for (const uint32_t index : triangles_[k])
      from = from.cwiseMin(vertices_[index].head<2>()), to = to.cwiseMax(vertices_[index].head<2>());
    for (size_t j = cell_of(from.y(), low_.y()); j <= std::min(rows_ - 1, cell_of(to.y(), low_.y())); ++j)
      for (size_t i = cell_of(from.x(), low_.x()); i <= std::min(columns_ - 1, cell_of(to.x(), low_.x())); ++i)
        cells_[j * columns_ + i].push_back(k);
  }
}

size_t Mesh::cell_of(double value, double low) const {
  return static_cast<size_t>(std::max(0.0, (value - low) / cell_m_));
}

std::vector<double> Mesh::heights_at(double east_m, double north_m) const {
  std::vector<double> heights;
  if (!(east_m >= low_.x() && north_m >= low_.y())) return heights;
  const double column = (east_m - low_.x()) / cell_m_, row = (north_m - low_.y()) / cell_m_;
  if (column >= static_cast<double>(columns_) || row >= static_cast<double>(rows_)) return heights;
  for (const uint32_t k : cells_[static_cast<size_t>(row) * columns_ + static_cast<size_t>(column)]) {
    const Eigen::Vector3d &a = vertices_[triangles_[k][0]], &b = vertices_[triangles_[k][1]],
                          &c = vertices_[triangles_[k][2]];
    Eigen::Matrix2d edges;
    edges.col(0) = (b - a).head<2>(), edges.col(1) = (c - a).head<2>();
    const double area = edges.determinant(), x = east_m - a.x(), y = north_m - a.y();
    const double u = (x * edges(1, 1) - y * edges(0, 1)) / area, v = (y * edges(0, 0) - x * edges(1, 0)) / area;
    if (u < -kEdge || v < -kEdge || u + v > 1 + kEdge) continue;
    heights.push_back(a.z() + u * (b.z() - a.z()) + v * (c.z() - a.z()));
  }
  return heights;
}

bool Terrain::height_at(double east, double north, double expected_m, double& height_m) const {
  if (const auto* grid = std::get_if<Grid>(&surface_)) return height_of(*grid, east, north, height_m);
  const auto heights = std::get<Mesh>(surface_).heights_at(east, north);
  if (heights.empty()) return false;
  height_m = *std::min_element(heights.begin(), heights.end(),
                               [&](double a, double b) { return std::abs(a - expected_m) < std::abs(b - expected_m); });
  return true;
}

}  // namespace odograph::terrain
