// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/sky_finder.hpp"

namespace odograph::skyline {

/// Where the camera is, from the prior: m and rad. The inclination turns first, about north and east; then the yaw.
struct Guess {
  double north = 0, east = 0, yaw = 0, tilt_north = 0, tilt_east = 0, up = 0;

  Eigen::Quaterniond rotation() const;
};

/// A picture's skyline by azimuth and elevation in n as the prior has it, to be laid over a model's.
class SeenSkyline {
 public:
  /// Chosen by hand, and not tuned.
  struct Parameters {
    double min_weight = 0.1;  ///< of a direction that is not sure at all: it is right more often than not
    size_t stride = 3;        ///< directions from one of a coarse search to the next
    double steepest = 20;     ///< tangent of the elevation: towards the zenith an azimuth means nothing
  };

  void set(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c);
  size_t size() const { return rays_.size(); }
  double lowest_rad() const { return lowest_; }

  /// Mean loss of a direction, rad, from the model's skyline of the guess's place, by the weights of the directions:
  /// `max_rad` at most, and none where the sky goes on below the picture's border and the model's roof lies there too.
  struct Sum {
    double value = 0, weight = 0;
    double mean() const { return value / std::max(weight, 1e-9); }
  };
  void add_loss(const Horizon& model, const Guess& guess, double max_rad, Sum& sum) const;
  double loss(const Horizon& model, const Guess& guess, double max_rad) const {
    Sum sum;
    add_loss(model, guess, max_rad, sum);
    return sum.mean();
  }
  /// The same of every third direction, turned by half degrees alone, for coarse searches. `twice`: the elevations of
  /// the model's directions, twice one after the other.
  using Twice = std::array<float, 2 * Horizon::kDirections>;
  double turned_loss(const Twice& twice, int half_degrees, double max_rad) const;
  /// A direction in short: the azimuth and elevation, rad, and what a model's roof above and below it counts.
  struct Summary {
    double azimuth, elevation, above, below;
  };
  std::vector<Summary> summary() const;
  size_t turned_size() const { return turned_.size(); }
  double turned_weight() const { return static_cast<double>(turned_weight_); }
  /// Part of the directions whose loss is below a bound, of those in which the picture or the model has a roof's edge:
  /// open sky that is open in the model too says little.
  void add_agreement(const Horizon& model, const Guess& guess, double bound_rad, Sum& sum) const;
  double agreement(const Horizon& model, const Guess& guess, double bound_rad) const {
    Sum sum;
    add_agreement(model, guess, bound_rad, sum);
    return sum.weight > 0 ? sum.value / sum.weight : 0;
  }
  /// Sum of the weights: as many directions as count.
  double total_weight() const { return total_weight_; }
  /// The azimuths between which all directions lie, clockwise, rad: a full circle apart where they lie all around.
  std::pair<double, double> azimuths() const;

  /// A direction's signed difference, model less picture, rad; 0 where one-sided knowledge is fulfilled.
  struct Residual {
    double azimuth, value, weight;
    double slope;  ///< tangent of its elevation
    double cosine, sine;
  };
  void residuals(const Horizon& model, const Guess& guess, std::vector<Residual>& out) const;

 private:
  struct Ray {
    double azimuth, elevation, slope, cosine, sine;  // slope: tangent of the elevation; of the azimuth the others
    double below;  // what counts of a roof seen above the model's: 0 where the picture ends, else 1
    double above;  // what counts of a roof seen below the model's: 0 where the picture begins below the edge
    double weight;
  };
  struct Turned {
    int direction;  // of the model's
    float elevation, below, above, weight;
  };
  double difference(const Ray& ray, const Horizon& model, const Guess& guess) const;

  std::vector<Ray> rays_;
  std::vector<Turned> turned_;
  float turned_weight_ = 0;
  double lowest_ = 0, total_weight_ = 0;
};

}  // namespace odograph::skyline
