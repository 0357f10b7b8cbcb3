// SPDX-License-Identifier: Apache-2.0
//
// Fit of a picture's skyline to a model whose roofs have errors of metres.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/seen_skyline.hpp"

namespace odograph::skyline {

/// Errors of a model's roofs and of a picture's sky. Unless a source is named, chosen empirically on rendered pictures
/// of Delft and Linz (`odograph city bench-photographs`).
struct RoofErrorParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  double line_rad = 0.15 * kDegree;  ///< sigma of a direction of the observed line
  double detail_m = 0.05;            ///< sigma of a roof's form: eaves, chimneys, dormers
  double building_m =
      1.5;  ///< sigma of a building's height in a LoD1 or LoD2 model (Kaartinen et al. 2005: 0.3 to 3 m by method)
  double above_loss = 3.5;            ///< max cost of a direction where something is above the model: trees, new houses
  double below_loss = 4.5;            ///< the same where sky is visible instead of the model's roof
  double agrees_rad = 0.3 * kDegree;  ///< max difference of a direction in which picture and model agree, or two sigmas
  /// Cost of a run of directions with an object that the model lacks (a new house, a tree), for its free ends and
  /// height; and cost per direction, higher where sky is visible instead of the model's roof.
  double run_loss = 6, run_above = 0.6, run_below = 0.7;
  double correlated = 5;  ///< neighbouring directions with a common error: two and a half degrees
};

/// The model's skyline from a place, with the object of each direction.
struct RoofLine {
  static constexpr int kDirections = Horizon::kDirections;
  std::array<float, kDirections> elevation{};      ///< rad
  std::array<float, kDirections> per_m{};          ///< derivative of the elevation by the roof's height, rad/m
  std::array<float, kDirections> inverse_sigma{};  ///< 1/rad, without the building's height error
  std::array<float, kDirections> width{};          ///< logarithm of the sigma over the line's
  std::array<int16_t, kDirections> object{};       ///< local number from 0; -1: none
  int objects = 0;

  /// `edge_indices`: indices into `edges`.
  void set(const Horizon& horizon, const City::EdgeIndices& edge_indices, const std::vector<Edge>& edges,
           const RoofErrorParameters& parameters);
};

/// A picture's skyline and its fit to roof lines: a negative log-likelihood.
class RoofLineFit {
 public:
  explicit RoofLineFit(const RoofErrorParameters& parameters) : p_(parameters) {}
  void set(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c);
  size_t directions() const { return rays_.size(); }
  /// Cost with the best-fitting height of each building and the cost of that freedom. `stride`: use every n-th
  /// direction only, for a search.
  double cost(const RoofLine& model, const Guess& guess, size_t stride = 1);
  /// Cost if nothing fitted: the reference for cost(), higher for a picture with many roofs.
  double no_match_cost() const;
  /// After cost(): fraction of the directions with a roof's edge that agree.
  double agreement() const { return edge_weight_ > 0 ? agreeing_ / edge_weight_ : 0; }

 private:
  struct Ray {
    double azimuth, elevation, slope, cosine, sine, weight;
    bool open, above;
  };
  struct Residual {
    double value, per_m, inverse_sigma, width, weight;
    bool edge;         // both sides visible
    size_t direction;  // of directions_
    int next;          // next residual of the same object
  };
  struct Direction {
    double known, unknown;  // cost as the model's roof, and as an object that the model lacks
  };
  int direction_of(const Ray& ray, const Guess& guess, double& tilt) const;
  /// Negative logarithm of Student's density with two degrees of freedom, at most `most`: some roofs match the model to
  /// centimetres, others do not. `width` normalises the density.
  double loss(double x, double width, double most) const {
    return std::min(most, width + 1.5 * std::log1p(0.5 * x * x));
  }
  double most(double value) const { return value > 0 ? p_.below_loss : p_.above_loss; }
  bool agrees(double value, double inverse_sigma) const {
    return std::abs(value) < std::max(p_.agrees_rad, 2 / inverse_sigma);
  }
  double offset_of(int first, double& information) const;
  double divided() const;

  RoofErrorParameters p_;
  std::vector<Ray> rays_;
  std::vector<Residual> residuals_;
  std::vector<Direction> directions_;  // with information
  std::vector<int> first_;             // first residual of each object
  double agreeing_ = 0, edge_weight_ = 0;
  double correlated_ = 1;  // evaluated directions with a common error
};

}  // namespace odograph::skyline
