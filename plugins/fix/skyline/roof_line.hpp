// SPDX-License-Identifier: Apache-2.0
//
// How well a picture's skyline fits a model's whose roofs are wrong by metres.
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

/// What a model's roofs and a picture's sky err by. By hand on rendered pictures of Delft (`odograph city bench`) where
/// no source is named.
struct RoofErrorParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  double line_rad = 0.15 * kDegree;  ///< sigma of a direction of the seen line
  double detail_m = 0.05;            ///< sigma of a roof's form: eaves, chimneys, dormers
  double building_m = 1.5;           ///< sigma of a building's height in a LoD1 or LoD2 model, the same over all of it
                                     ///< (Kaartinen et al. 2005: 0.3 to 3 m by method)
  double above_loss =
      3.5;  ///< most that a direction costs in which something stands above the model: trees, new houses
  double below_loss = 4.5;            ///< the same in which the sky is seen where the model has a roof
  double agrees_rad = 0.3 * kDegree;  ///< of a direction in which picture and model agree, or two sigmas
  /// A run of directions with something that the model lacks (a new house, a tree) costs this, as its two ends and its
  /// height may be anything, and so much a direction; more where the sky is seen instead of the model's roof.
  double run_loss = 9, run_above = 0.35, run_below = 0.5;
  double correlated = 5;  ///< neighbouring directions that err together: two and a half degrees
  double trust = 1;       ///< of the whole: a power of the likelihood
};

/// The model's skyline from a place, with whose roof each direction is.
struct RoofLine {
  static constexpr int kDirections = Horizon::kDirections;
  std::array<float, kDirections> elevation{};      ///< rad
  std::array<float, kDirections> per_m{};          ///< rad by which it rises where that roof is a metre higher
  std::array<float, kDirections> inverse_sigma{};  ///< 1/rad, without the building's
  std::array<float, kDirections> width{};          ///< logarithm of the sigma over the line's own
  std::array<int16_t, kDirections> object{};       ///< from 0, numbered here; -1 nothing
  int objects = 0;

  /// `objects_of`: by number of an edge.
  void set(const Horizon& horizon, const City::Winners& winners, const std::vector<Edge>& edges,
           const RoofErrorParameters& parameters);
};

/// A picture's skyline, and its fit to roof lines: minus the logarithm of a likelihood.
class RoofLineFit {
 public:
  explicit RoofLineFit(const RoofErrorParameters& parameters) : p_(parameters) {}
  void set(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c);
  size_t directions() const { return rays_.size(); }
  /// With the height of each building that fits best, and what that freedom costs. `stride`: of every so manieth
  /// direction alone, for a search.
  double cost(const RoofLine& model, const Guess& guess, size_t stride = 1);
  /// What it would cost if nothing fitted: a trusted picture with many roofs is worth more than one with few.
  double nothing() const;
  /// After cost(): part of the directions with a roof's edge that agree.
  double agreement() const { return edge_weight_ > 0 ? agreeing_ / edge_weight_ : 0; }

 private:
  struct Ray {
    double azimuth, elevation, slope, cosine, sine, weight;
    bool open, above;
  };
  struct Residual {
    double value, per_m, inverse_sigma, width, weight;
    bool edge;         // both sides known
    size_t direction;  // of directions_
    int next;          // of the same object
  };
  struct Direction {
    double known, unknown;  // what it costs as the model's roof, and as something that the model lacks
  };
  int direction_of(const Ray& ray, const Guess& guess, double& tilt) const;
  /// Minus the logarithm of a density, Student's with two degrees of freedom: some roofs are as the model has them to
  /// centimetres, others not. A wide one is low everywhere. Never more than `most`.
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
  std::vector<Direction> directions_;  // that tell anything
  std::vector<int> first_;             // of each object
  double agreeing_ = 0, edge_weight_ = 0;
  double correlated_ = 1;  // directions looked at that err together
};

}  // namespace odograph::skyline
