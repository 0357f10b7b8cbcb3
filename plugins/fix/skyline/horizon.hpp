// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/fix/skyline/sliced_worker.hpp"

namespace odograph::skyline {

/// Chosen by hand, and not tuned.
struct HorizonParameters {
  double same_rad = 0.035;  ///< two degrees between neighbours: more is a wall's edge, not a roof's slope
  int lattice = 2;          ///< places to each side from which edges are looked for
};

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

/// The directions that somebody looks at, in blocks of eight: from `first`, `blocks` of them.
struct Sector {
  static constexpr int kBlock = 8, kBlocks = Horizon::kDirections / kBlock;
  int first = 0, blocks = kBlocks;

  static Sector all() { return {}; }
  /// The blocks that azimuths from `from_rad` clockwise to `to_rad` lie in.
  static Sector between(double from_rad, double to_rad);
};

/// What an edge (n, m) shows at directions from `first` until before `end` from a place; between its ends where
/// rounding would say that a direction passes them by. False, and nothing of worth, where it is seen from its own line.
bool trace_edge(const float from_n[3], const float to_n[3], const float p_n[3], int first, int end, Horizon& out);

/// Skylines of a city model, from anywhere.
class City {
 public:
  explicit City(std::vector<Edge> edges) : edges_(std::move(edges)) {}

  /// Keeps the edges that can be seen at more than an elevation of `min_tan` from within `radius_m` of a place and
  /// from up to `lower_m` below it, for horizon() alone.
  void look_near(const Eigen::Vector3d& p_n, double radius_m, double min_tan, double lower_m = 0);
  /// The same for quick_horizon() too. `spend` is told of the work before it is done.
  void look_around(const Eigen::Vector3d& p_n, double radius_m, double min_tan, double lower_m = 0,
                   const Spend& spend = nullptr);
  /// The skyline from a place, of the edges that look_around() kept. Thread: any, between calls of look_around().
  void horizon(const Eigen::Vector3d& p_n, Horizon& out) const { envelope(near_, p_n, out, nullptr, Sector::all()); }
  /// With the number of the edge that is highest in each direction, -1 where none is.
  using Winners = std::array<int, Horizon::kDirections>;
  void horizon(const Eigen::Vector3d& p_n, Horizon& out, Winners& winners) const;
  const std::vector<Edge>& edges() const { return edges_; }
  /// What horizon() and quick_horizon() cost, for a Spend.
  uint64_t work() const { return work_of(near_, Sector::all()); }
  uint64_t quick_work(const Sector& sector = Sector::all()) const { return work_of(visible_, sector); }
  /// The same of those edges alone that are seen from one place or another of a lattice over the radius: many times
  /// faster, and without what shows in a gap between two places of the lattice only. Elevations outside of the sector
  /// are 0.
  void quick_horizon(const Eigen::Vector3d& p_n, Horizon& out, const Sector& sector = Sector::all()) const {
    envelope(visible_, p_n, out, nullptr, sector);
  }
  /// The same with the number of the edge that is highest in each direction.
  void quick_horizon(const Eigen::Vector3d& p_n, Horizon& out, Winners& winners) const;

 private:
  static constexpr uint64_t kEdgeWork = 8;  // directions that an edge costs in the mean, measured
  struct Near {
    float x, y, z, dx, dy, dz;    // from the place that was looked around
    float bound;                  // most that its elevation's tangent can be within the radius
    int number;                   // among all edges
    int16_t first_block, blocks;  // of directions in which it can lie within the radius; all where it is near
  };
  static uint64_t work_of(const std::vector<Near>& edges, const Sector& sector) {
    // Of an edge that is not looked at a third of the work is left: to find that out.
    const auto looked_at = static_cast<uint64_t>(sector.blocks);
    return (kEdgeWork * edges.size() + Horizon::kDirections) * (Sector::kBlocks + 2 * looked_at) /
           (3 * Sector::kBlocks);
  }
  void envelope(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, Horizon& out, Winners* winners,
                const Sector& sector) const;

  std::vector<Edge> edges_;
  std::vector<Near> near_, visible_;
  Eigen::Vector3d around_ = Eigen::Vector3d::Zero();
  double radius_m_ = 0, lower_m_ = 0;
};

}  // namespace odograph::skyline
