// SPDX-License-Identifier: Apache-2.0
//
// Place and heading of a photograph from the directions of the facades that it shows.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/fix/skyline/vanishing_point.hpp"

namespace odograph::skyline {

/// Unless a source is named, chosen empirically on rendered pictures of Linz, The Hague and Delft
/// (`odograph city bench --photographs`, seeds 161 to 181).
struct FacadeParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  double reach_m = 60;                     ///< max distance of a wall from the camera
  double step_m = 0.5;                     ///< of the lattice from whose places the walls in view are computed,
  size_t max_places = 20'000;              ///< and how many of those are kept: 30 MB
  double min_above_m = 1.5;                ///< of a wall's top above the camera: lower ones do not hide facades
  double min_wall_m = 1;                   ///< length of an edge in plan
  double max_wall_m = 500;                 ///< a longer one is an error of the model; judgement
  double max_slope = 0.5;                  ///< of an edge: steeper ones are verges and hips
  double vertical_rad = 6 * kDegree;       ///< a line's plane nearer to the vertical may be that of an upright line
  double line_rad = 0.8 * kDegree;         ///< sigma of that plane in addition to the camera's inclination
  double wall_rad = 1 * kDegree;           ///< sigma of a wall's direction in the model
  double max_sigma_rad = 8 * kDegree;      ///< of a line's direction; lines near the horizon have a larger one
  double min_elevation_rad = 2 * kDegree;  ///< of a line: lower ones are often on the ground
  double contradicting = 0.1;      ///< fraction of photographs whose lines have nothing to do with the model; judgement
  double on_wall = 0.5;            ///< fraction of the lines that are horizontal and on the model's wall; judgement
  double part_rad = 3 * kDegree;   ///< a longer line is compared in several bearings
  double alike_rad = 2 * kDegree;  ///< lines that differ less in bearing and direction are one
  double max_lines = 3;            ///< max number of independent lines; by seeds 201 to 251
};

/// Likelihood of a place and a heading from the horizontal lines of a picture: ledges, rows of windows, eaves. Such a
/// line of known inclination of the camera has one possible direction, that of its wall (Coughlan & Yuille 1999 do so
/// for cities of two directions); here the model's nearest wall in the line's bearing must have it. Independent of the
/// roofs' heights. Thread: one at a time.
class Facades {
 public:
  Facades(const std::vector<Edge>& edges, const FacadeParameters& parameters);
  explicit Facades(const std::vector<Edge>& edges) : Facades(edges, FacadeParameters{}) {}

  /// Starts a photograph: forgets the places, whose walls depend on the camera's height.
  void clear() { seen_.clear(); }
  /// The horizontal lines of a picture; `tilt_sigma_rad`: of the camera's inclination.
  void set(const std::vector<SeenLine>& lines, const Eigen::Quaterniond& q_n_c, double tilt_sigma_rad);
  /// Negative log-likelihood of the lines' directions from the camera's place with a heading relative to that of set(),
  /// over that of lines of any direction. Without a step between places.
  double cost(const Eigen::Vector3d& p_n, double yaw);
  size_t lines() const { return lines_.size(); }

 private:
  static constexpr int kBearings = 360;
  struct Wall {
    Eigen::Vector2d from, to;
    double top;  // down in n
  };
  struct Line {
    float bearing, direction, inverse_sigma, weight;
  };
  using Directions = std::array<float, kBearings>;  // of the nearest wall, by bearing, rad; NaN where there is none
  const Directions& directions_from(int64_t north, int64_t east, double down);
  Directions nearest_walls(const Eigen::Vector3d& p_n) const;
  double cost_of_lines(const Directions& walls, double yaw) const;

  FacadeParameters p_;
  std::unordered_map<int64_t, std::vector<Wall>> walls_;  // by cells of reach_m
  std::unordered_map<int64_t, Directions> seen_;          // from places of the lattice
  std::vector<Line> lines_;
};

}  // namespace odograph::skyline
