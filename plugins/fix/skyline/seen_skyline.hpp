// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/binary_sky.hpp"
#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/sky_finder.hpp"

namespace odograph::skyline {

/// The camera's pose relative to the prior, m and rad. The inclination, about north and east, is applied before the
/// yaw.
struct Guess {
  double north = 0, east = 0, yaw = 0, tilt_north = 0, tilt_east = 0, up = 0;

  Eigen::Quaterniond rotation() const;
};

/// A picture's skyline by azimuth and elevation in n by the prior's attitude, for comparison with a model's.
class SeenSkyline {
 public:
  /// Chosen empirically, not tuned.
  struct Parameters {
    double min_weight = 0.1;  ///< of a direction with zero confidence: it is correct more often than not
    size_t stride = 3;        ///< coarse searches use every third direction
    double steepest = 20;     ///< max tangent of the elevation: the azimuth is undefined towards the zenith
  };

  void set(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c);
  size_t size() const { return rays_.size(); }
  double lowest_rad() const { return lowest_; }

  /// Mean loss of a direction, rad, from the model's skyline at the guess's place, weighted. The loss of a direction is
  /// at most `max_rad`, and 0 where the sky extends below the picture's border and the model's roof lies below it too.
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
  /// The picture's binary image from the guess, without weights.
  BinarySky image(const Guess& guess) const;
  /// The same over every third direction and rotations by half degrees only, for coarse searches. `twice`: the
  /// elevations of the model's directions, repeated twice.
  using Twice = std::array<float, 2 * Horizon::kDirections>;
  double turned_loss(const Twice& twice, int half_degrees, double max_rad) const;
  /// Summary of a direction: azimuth and elevation, rad, and the weights of a model's roof above and below it.
  struct Summary {
    double azimuth, elevation, above, below;
  };
  std::vector<Summary> summary() const;
  size_t turned_size() const { return turned_.size(); }
  double turned_weight() const { return static_cast<double>(turned_weight_); }
  /// Fraction of the directions with a loss below a bound, among those in which the picture or the model has a roof's
  /// edge: open sky that is open in the model too has little information.
  void add_agreement(const Horizon& model, const Guess& guess, double bound_rad, Sum& sum) const;
  double agreement(const Horizon& model, const Guess& guess, double bound_rad) const {
    Sum sum;
    add_agreement(model, guess, bound_rad, sum);
    return sum.weight > 0 ? sum.value / sum.weight : 0;
  }
  /// Sum of the directions' weights.
  double total_weight() const { return total_weight_; }
  /// The azimuths, rad, that bound all directions clockwise: a full circle apart where they cover it.
  std::pair<double, double> azimuths() const;

  /// A direction's signed difference, model minus picture, rad; 0 where a one-sided bound is satisfied.
  struct Residual {
    double azimuth, value, weight;
    double slope;  ///< tangent of its elevation
    double cosine, sine;
  };
  void residuals(const Horizon& model, const Guess& guess, std::vector<Residual>& out) const;

 private:
  struct Ray {
    double azimuth, elevation, slope, cosine, sine;  // slope: tangent of the elevation; cosine and sine of the azimuth
    double below;  // weight where the observed edge is above the model's: 0 where the picture ends, else 1
    double above;  // weight where the observed edge is below the model's: 0 where the picture begins below the edge
    double weight;
  };
  struct Turned {
    int direction;  // of the model
    float elevation, below, above, weight;
  };
  double difference(const Ray& ray, const Horizon& model, const Guess& guess) const;

  std::vector<Ray> rays_;
  std::vector<Turned> turned_;
  float turned_weight_ = 0;
  double lowest_ = 0, total_weight_ = 0;
};

}  // namespace odograph::skyline
