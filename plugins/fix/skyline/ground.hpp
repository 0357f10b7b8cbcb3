// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "plugins/fix/skyline/city_outline.hpp"

namespace odograph::skyline {

/// The ground under a city model, out of its edges: of its terrain near a place where it has some, otherwise between
/// the lowest corners of the buildings around. Thread: any.
class Ground {
 public:
  /// Judgement.
  struct Parameters {
    double cell_m = 20;     ///< in which points are looked up
    double terrain_m = 15;  ///< terrain farther away than this says less than the feet of buildings
    double reach_m = 60;    ///< of a foot; farther away nothing is known of the ground
    double near_m = 4;      ///< nearer than this two points count alike
    double foot_m = 0.3;    ///< above an object's lowest corner, of a corner that stands on the ground
  };

  Ground(const std::vector<Edge>& edges, const Parameters& parameters);
  explicit Ground(const std::vector<Edge>& edges) : Ground(edges, Parameters{}) {}

  /// Height of the ground at a place, m down in n.
  struct At {
    double down_m;
    bool terrain;  ///< the model's own; false: between buildings
  };
  std::optional<At> at(const Eigen::Vector2d& north_east) const;
  /// Whether a place lies within the foot of a building whose lowest edges close around it.
  bool is_built(const Eigen::Vector2d& north_east) const;

 private:
  struct Point {
    float north, east, down;
  };
  struct Foot {
    Eigen::Vector2f low, high;
    std::vector<std::array<Eigen::Vector2f, 2>> edges;
  };
  using Cells = std::unordered_map<int64_t, std::vector<Point>>;
  int64_t cell_of(double north, double east) const;
  void add(const Eigen::Vector3d& p_n, Cells& to) const;
  static void add_foot(const Edge& edge, Foot& foot);
  static bool is_closed(const Foot& foot);
  void index_buildings();
  std::optional<double> mean(const Cells& cells, const Eigen::Vector2d& at, double reach_m) const;

  Parameters p_;
  Cells terrain_, feet_;
  std::vector<Foot> buildings_;
  std::unordered_map<int64_t, std::vector<uint32_t>> buildings_of_;  // by cell
};

}  // namespace odograph::skyline
