// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <unordered_map>
#include <vector>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/fix/skyline/sliced_worker.hpp"

namespace odograph::skyline {

/// Chosen empirically, not tuned.
struct HorizonParameters {
  double same_rad = 0.035;  ///< two degrees between neighbours: more is a wall's edge instead of a roof's slope
  int lattice = 2;          ///< places to each side from which visible edges are collected
  int roof_lattice = 3;     ///< the same for roofs
};

/// The skyline around a place: eq. (2) of Gakne & O'Keefe 2018, N = 720 directions from north to the east, each in the
/// middle of its half degree.
struct Horizon {
  static constexpr int kDirections = 720;
  std::array<float, kDirections> elevation{};   ///< rad, of the highest edge; 0 where there is none
  std::array<float, kDirections> height_m{};    ///< of the skyline's point above the place
  std::array<float, kDirections> distance_m{};  ///< horizontal, of that point; 0 where there is none

  /// The elevation at any azimuth, rad, interpolated between the two nearest directions. At a house's vertical edge it
  /// is that of the nearer one, since there is no slope to interpolate.
  double elevation_at(double azimuth_rad) const;
};

/// A range of directions in blocks of eight: `blocks` of them from `first`.
struct Sector {
  static constexpr int kBlock = 8, kBlocks = Horizon::kDirections / kBlock;
  int first = 0, blocks = kBlocks;

  static Sector all() { return {}; }
  /// The blocks that contain the azimuths from `from_rad` clockwise to `to_rad`.
  static Sector between(double from_rad, double to_rad);
};

/// Elevation, height and distance of an edge (n, m) seen from a place, at the directions [first, end). The intersection
/// is clamped to the edge's ends against rounding. False, with undefined output, where the place is on the edge's line.
bool trace_edge(const float from_n[3], const float to_n[3], const float p_n[3], int first, int end, Horizon& out);

/// The highest point of one object in one direction from a place.
struct RoofTop {
  static constexpr int kMax = 6;  ///< of a direction
  int object;                     ///< Edge::object; of an edge without one: below Edge::kGround, for each edge another
  int edge;
  float height_m, distance_m;  ///< above the place; horizontal
};
/// Of each direction: the objects that can be the skyline there, in no order.
struct RoofTops {
  std::array<std::array<RoofTop, RoofTop::kMax>, Horizon::kDirections> of;
  std::array<uint8_t, Horizon::kDirections> count;
};

/// Computes skylines of a city model from any place. Copies share the model's edges.
class City {
 public:
  explicit City(std::vector<Edge> edges) : edges_(std::make_shared<const std::vector<Edge>>(std::move(edges))) {}

  /// Selects the edges that can appear above an elevation of tangent `min_tan` from within `radius_m` of a place and
  /// from up to `lower_m` below it, for horizon() only.
  void select_near_edges(const Eigen::Vector3d& p_n, double radius_m, double min_tan, double lower_m = 0);
  /// The same for quick_horizon() too. `spend` is called with the amount of work before it is done.
  void select_edges(const Eigen::Vector3d& p_n, double radius_m, double min_tan, double lower_m = 0,
                    const Spend& spend = nullptr);
  /// The skyline from a place, of the edges that select_edges() selected. Thread: any, between calls of select_edges().
  void horizon(const Eigen::Vector3d& p_n, Horizon& out) const { envelope(near_, p_n, out, nullptr, Sector::all()); }
  /// With the number of the edge that is highest in each direction, -1 where none is.
  using EdgeIndices = std::array<int, Horizon::kDirections>;
  void horizon(const Eigen::Vector3d& p_n, Horizon& out, EdgeIndices& edge_indices) const;
  const std::vector<Edge>& edges() const { return *edges_; }
  /// The same city with its roofs higher by these heights, m, by object.
  City with_roof_offsets(const std::unordered_map<int, double>& heights_m) const;
  /// Work of horizon() and quick_horizon(), for a Spend.
  uint64_t work() const { return work_of(near_, Sector::all()); }
  uint64_t quick_work(const Sector& sector = Sector::all()) const { return work_of(visible_, sector); }
  /// The same with only the edges that are visible from at least one place of a lattice over the radius: many times
  /// faster, but it misses edges that are visible only between two places of the lattice. Elevations outside the sector
  /// are 0.
  void quick_horizon(const Eigen::Vector3d& p_n, Horizon& out, const Sector& sector = Sector::all()) const {
    envelope(visible_, p_n, out, nullptr, sector);
  }
  /// The edges that roof_tops() needs at places within the radius.
  std::vector<int> roofs_around(const Eigen::Vector3d& p_n, double radius_m, double min_tan, double lower_m,
                                double spread_m, const Spend& spend = nullptr);
  /// Selects those of the edges that roof_tops() needs within a smaller radius: the smaller, the faster it is.
  void select_roofs(const std::vector<int>& roofs, const Eigen::Vector3d& p_n, double radius_m, double min_tan,
                    double lower_m, double spread_m, const Spend& spend = nullptr);
  /// The objects that can be the skyline from a place if each object's roofs are up to `spread_m` higher or lower than
  /// in the model, of the edges that select_roofs() selected with the same spread.
  void roof_tops(const Eigen::Vector3d& p_n, double spread_m, const Sector& sector, RoofTops& out) const {
    trace_roofs(visible_, p_n, spread_m, sector, out);
  }

 private:
  static constexpr uint64_t kEdgeWork = 8;  // mean number of directions per edge, measured
  struct Near {
    float x, y, z, dx, dy, dz;    // from the place of select_edges()
    float bound;                  // max tangent of its elevation within the radius
    int number;                   // among all edges
    int16_t first_block, blocks;  // of directions that it can occupy within the radius; all where it is near
    bool ground;
  };
  std::vector<Near> near_of(const std::vector<int>& numbers, const Eigen::Vector3d& p_n, double radius_m,
                            double min_tan, double lower_m);
  static uint64_t work_of(const std::vector<Near>& edges, const Sector& sector) {
    // An edge outside the sector still costs a third of the work: the test for that.
    const auto looked_at = static_cast<uint64_t>(sector.blocks);
    return (kEdgeWork * edges.size() + Horizon::kDirections) * (Sector::kBlocks + 2 * looked_at) /
           (3 * Sector::kBlocks);
  }
  void envelope(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, Horizon& out, EdgeIndices* edge_indices,
                const Sector& sector) const;
  template <class Hiding, class Visit>
  void visit_edges(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, double raised_m, const Hiding& hiding,
                   const Visit& visit) const;
  void trace_roofs(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, double spread_m, const Sector& sector,
                   RoofTops& out) const;

  std::shared_ptr<const std::vector<Edge>> edges_;
  std::vector<Near> near_, visible_;
  Eigen::Vector3d around_ = Eigen::Vector3d::Zero();
  double radius_m_ = 0, lower_m_ = 0;
};

}  // namespace odograph::skyline
