// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "plugins/fix/skyline/city_outline.hpp"

namespace odograph::skyline {

/// Where the sky ends around a place: eq. (2) of Gakne & O'Keefe 2018, N = 720 directions from north to the east, each
/// in the middle of its half degree.
struct Horizon {
  static constexpr int kDirections = 720;
  std::array<float, kDirections> elevation{};   ///< rad, the highest; 0 where nothing is
  std::array<float, kDirections> height_m{};    ///< of the point there, above the place
  std::array<float, kDirections> distance_m{};  ///< of it, horizontally; 0 where nothing is

  /// The elevation at any azimuth, rad, between the two nearest directions; at a house's vertical edge that of the
  /// nearer one, since nothing is between them.
  double elevation_at(double azimuth_rad) const;
};

/// Skylines of a city model, from anywhere.
class City {
 public:
  explicit City(std::vector<Edge> edges) : edges_(std::move(edges)) {}

  /// Keeps the edges that can be seen at more than an elevation of `least_tan` from within `radius_m` of a place and
  /// from up to `lower_m` below it.
  void look_around(const Eigen::Vector3d& p_n, double radius_m, double least_tan, double lower_m = 0);
  /// The skyline from a place, of the edges that look_around() kept. Thread: any, between calls of look_around().
  void horizon(const Eigen::Vector3d& p_n, Horizon& out) const { envelope(near_, p_n, out, nullptr); }
  /// The same of those edges alone that are seen from one place or another of a lattice over the radius: many times
  /// faster, and without what shows in a gap between two places of the lattice only.
  void quick_horizon(const Eigen::Vector3d& p_n, Horizon& out) const { envelope(visible_, p_n, out, nullptr); }

 private:
  struct Near {
    float x, y, z, dx, dy, dz;  // from the place that was looked around
    float bound;                // most that its elevation's tangent can be there
  };
  using Winners = std::array<int, Horizon::kDirections>;  // which edge is the highest, -1 none
  void envelope(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, Horizon& out, Winners* winners) const;

  std::vector<Edge> edges_;
  std::vector<Near> near_, visible_;
  Eigen::Vector3d around_ = Eigen::Vector3d::Zero();
};

}  // namespace odograph::skyline
