// SPDX-License-Identifier: Apache-2.0
//
// Fit of a picture's skyline to a model whose roofs have errors of metres.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/matcher.hpp"
#include "plugins/fix/skyline/seen_skyline.hpp"

namespace odograph::skyline {

/// Errors of a model's roofs and of a picture's sky. Unless a source is named, chosen empirically on rendered pictures
/// of Delft and Linz (`odograph city bench --photographs`).
struct RoofErrorParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  double line_rad = 0.05 * kDegree;       ///< sigma of a direction of the observed line
  double reference_rad = 0.15 * kDegree;  ///< sigma to which above_loss and below_loss refer
  double detail_m = 0.02;                 ///< sigma of a roof's form: eaves, chimneys, dormers
  double building_m =
      1.5;  ///< sigma of a building's height in a LoD1 or LoD2 model (Kaartinen et al. 2005: 0.3 to 3 m by method)
  double above_loss = 3.5;            ///< max cost of a direction where something is above the model: trees, new houses
  double below_loss = 4.5;            ///< the same where sky is visible instead of the model's roof
  double agrees_rad = 0.3 * kDegree;  ///< max difference of a direction in which picture and model agree, or two sigmas
  /// Cost of a run of directions with an object that the model lacks (a new house, a tree), for its free ends and
  /// height; and cost per direction, higher where sky is visible instead of the model's roof.
  double run_loss = 6, run_above = 0.6, run_below = 0.7;
  /// Of straight_gain(): cost of a straight edge of such an object, for its height, slope and end, instead of that per
  /// direction; and the sigma of its directions.
  double straight_loss = 9, straight_rad = 0.1 * kDegree;
  double absent_loss = 2.2;  ///< cost of a building of the model that is not there: a tenth
  double correlated = 5;     ///< neighbouring directions with a common error: two and a half degrees
};

/// The model's roofs against the sky from a place: of each direction all objects that can be the skyline there, since
/// a house that is lower than in the model shows those behind it.
struct RoofLine {
  static constexpr int kDirections = Horizon::kDirections;
  struct Layer {
    float elevation;  ///< rad
    float slope;      ///< derivative of the elevation by the azimuth
    float per_m;      ///< derivative of the elevation by the roof's height, rad/m
    int object;       ///< local number from 0; -1: ground
  };
  std::vector<Layer> layers;                    ///< by direction,
  std::array<uint32_t, kDirections + 1> first;  ///< from this one
  std::vector<int> objects;                     ///< Edge::object by local number

  void set(const RoofTops& tops);
  /// Whether a roof is above the camera.
  bool rises() const {
    return std::any_of(layers.begin(), layers.end(), [](const Layer& layer) { return layer.elevation > 0; });
  }
};

/// A picture's skyline and its fit to roof lines: a negative log-likelihood.
class RoofLineFit {
 public:
  explicit RoofLineFit(const RoofErrorParameters& parameters)
      : p_(parameters),
        outlier_above_(std::exp(2 * parameters.above_loss)),
        outlier_below_(std::exp(2 * parameters.below_loss)),
        line_rad_(parameters.line_rad) {}
  void set(std::vector<SkyEdge> edges, const Eigen::Quaterniond& q_n_c);
  size_t directions() const { return rays_.size(); }
  /// Cost with the best-fitting height of each building and the cost of that freedom. `stride`: use every n-th
  /// direction only, for a search.
  double cost(const RoofLine& model, const Guess& guess, size_t stride = 1);
  /// The directions of the model that the picture can have at headings from `from_rad` to `to_rad` of the guess.
  Sector sector(double from_rad, double to_rad) const {
    return Sector::between(middle_ - half_width_ + from_rad, middle_ + half_width_ + to_rad);
  }
  /// Sigma of a direction of the line for the next costs, rad.
  void set_line(double sigma_rad) { line_rad_ = sigma_rad; }
  /// Cost if nothing fitted: the reference for cost(), higher for a picture with many roofs.
  double no_match_cost() const;
  /// Gauss-Newton's normal equations in north, east, yaw, tilt_north, tilt_east and up (m, rad), the buildings' heights
  /// eliminated.
  struct NormalEquations {
    Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
  };
  /// After cost() with stride 1: of the directions in which picture and model agree, at the guess.
  NormalEquations normal_equations(const Guess& guess) const;
  /// After cost() with stride 1: of the model's objects in view.
  std::vector<RoofHeight> heights(const RoofLine& model) const;
  /// After cost() with stride 1: the fit's log-likelihood over that of straight edges of objects that the model lacks.
  double straight_gain() const;
  /// After cost(): fraction of the directions with a roof's edge that agree.
  double agreement() const { return edge_weight_ > 0 ? agreeing_ / edge_weight_ : 0; }

 private:
  struct Ray {
    double azimuth, elevation, slope, cosine, sine, weight;
    bool open, above;
    int edge;  // of straight_edges()
  };
  /// 1/rad, and the variance over the reference's.
  struct Accuracy {
    double inverse, variance;
  };
  Accuracy accuracy_of(double per_m) const {
    const double detail = p_.detail_m * per_m, variance = line_rad_ * line_rad_ + detail * detail;
    return {1 / std::sqrt(variance), variance / (p_.reference_rad * p_.reference_rad)};
  }
  struct Residual {
    const RoofLine::Layer* layer;
    double value;   // model minus picture, rad
    double offset;  // change of the roof's height that makes it 0, m
    int direction;
    int next;           // next residual of the same object
    bool top;           // the skyline of its direction
    Accuracy accuracy;  // of a top
  };
  struct Direction {
    int ray, first, end;    // its residuals, one for each layer
    double level;           // the horizon minus the picture, rad
    double known, unknown;  // cost as the model's roof, and as an object that the model lacks
    int top = -1;           // residual
  };
  struct Object {
    int first = -1;     // residual
    double offset = 0;  // of its roofs from the model, m
    double information = 0;
    bool absent = false, seen = false, changed = false;
  };
  size_t direction_of(const Ray& ray, const Guess& guess, double& tilt, double& aside) const;
  const Ray& ray_of(const Residual& r) const {
    return rays_[static_cast<size_t>(directions_[static_cast<size_t>(r.direction)].ray)];
  }
  /// Student's density with two degrees of freedom, normalised, to the power of -2: some roofs match the model to
  /// centimetres, others do not.
  static double inverse_density2(double value, const Accuracy& a) {
    const double x = value * a.inverse, q = 1 + 0.5 * x * x;
    return a.variance * q * q * q;
  }
  /// Its negative logarithm, at most that of an outlier.
  double loss(double value, const Accuracy& a) const {
    return std::min(value > 0 ? p_.below_loss : p_.above_loss, 0.5 * std::log(inverse_density2(value, a)));
  }
  bool is_outlier(double value, const Accuracy& a) const {
    return inverse_density2(value, a) >= (value > 0 ? outlier_below_ : outlier_above_);
  }
  bool agrees(double value, const Accuracy& a) const {
    return std::abs(value) < std::max(p_.agrees_rad, 2 / a.inverse);
  }
  void compare(const RoofLine& model, const Guess& guess, size_t stride);
  template <class Can>
  Residual* highest(const Direction& d, const Can& can);
  void set_top(Direction& d, Residual* top);
  void find_tops();
  double value_of(const Residual& residual) const;
  double cost_of(const Direction& d, const Residual* top) const;
  double cost_of_height(const Object& object, bool seen) const;
  void hide_needless(int number);
  double cost_of_heights();
  void vote(Object& object) const;
  void refine(Object& object) const;
  double loss_of_exact() const { return std::log(p_.line_rad / p_.reference_rad) / p_.correlated; }
  double divided() const;

  RoofErrorParameters p_;
  double outlier_above_, outlier_below_;  // inverse_density2() of one
  double line_rad_;
  Accuracy horizon_{};
  std::vector<Ray> rays_;
  double middle_ = 0, half_width_ = 0;  // azimuths of the rays
  std::vector<Residual> residuals_;
  std::vector<Direction> directions_;
  std::vector<Object> objects_;
  std::vector<std::pair<double, int>> order_;    // cost and number of the objects in view
  std::vector<std::pair<int, Residual*>> tops_;  // directions and their next layers, of an object
  double heights_cost_ = 0;                      // of the latest cost()
  double agreeing_ = 0, edge_weight_ = 0;
  double correlated_ = 1;  // evaluated directions with a common error
};

}  // namespace odograph::skyline
