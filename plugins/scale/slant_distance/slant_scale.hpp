// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Core>

namespace odograph::slant_scale {

struct Scale {
  double scale, sigma;
};

/// Scale from the positions P_3DBM of Gakne & O'Keefe 2018: one length in metres over the same length by the odometry.
/// The length is the distance between fixes; up to scale it is the sum of the displacements of eq. (6), with their
/// directions. The scale is the robust least-squares line through the fixes of the window, so that no single pair
/// dominates. The slant distance is not used: it cancels (docs/slant_distance.md).
///
/// Before the fixes extend far enough, the first two of them or the start and one of them give a first scale.
class SlantScale {
 public:
  /// Empirical, not tuned.
  struct Parameters {
    double huber = 1.5;         ///< standard deviations of a position beyond which the loss is linear
    double max_jump = 0.7;      ///< change of the log-scale within a window, a factor of two: a similar place
    int confirmations = 20;     ///< consecutive fixes that confirm the change
    double guess = 0.3;         ///< relative sigma of a scale from the previous speed
    double guess_s = 1;         ///< of motions from which it is computed
    double standing_mps = 0.5;  ///< below it the previous speed carries no information
    double first = 0.3;         ///< max relative sigma of a first scale from fixes that lie near each other
  };

  /// `scale_drift`: relative change of the odometry's scale within a window.
  SlantScale(double window_s, double min_displacement_m, double scale_drift)
      : window_s_(window_s), min_displacement_m_(min_displacement_m), scale_drift_(scale_drift) {}

  /// A motion's displacement in n, up to scale. A new group drops everything in the old scale, and starts with the
  /// final speed of the old group.
  void add_motion(int64_t from_ns, int64_t t_ns, const Eigen::Vector3d& d_n, uint32_t group);
  /// The position at which the path starts, m, and its variance per axis, m^2.
  void start_at(const Eigen::Vector2d& p_n, double variance);
  /// The vehicle's position by the city model, m, and the variance per axis, m^2.
  void add_position(int64_t t_ns, const Eigen::Vector2d& p_n, double variance);
  const std::optional<Scale>& scale() const { return scale_; }
  /// Whether the scale is from fixes that extend far enough: not a first one, nor one from the previous speed.
  bool known() const { return known_; }

 private:
  struct Point {
    int64_t t_ns;
    Eigen::Vector2d p;  // up to scale
  };
  struct Pair {
    int64_t t_ns;
    Eigen::Vector2d model_m, vo;
    double variance;
  };
  void fit();
  void guess(double dt_s, double distance);

  /// Median of the latest values: robust against a single wrong motion.
  class RunningMedian {
   public:
    void clear() { count_ = 0; }
    void add(double value) { values_[count_++ % values_.size()] = value; }
    double median() const;  ///< 0 without values

   private:
    std::array<double, 11> values_{};
    size_t count_ = 0;
  };

  Parameters p_;
  double window_s_, min_displacement_m_, scale_drift_;
  std::deque<Point> path_;
  std::deque<Pair> pairs_;
  Eigen::Vector2d at_ = Eigen::Vector2d::Zero();
  std::optional<uint32_t> group_;
  std::optional<Scale> scale_;
  int jumps_ = 0;
  bool known_ = false;       ///< from fixes, not from the previous speed
  RunningMedian speed_mps_;  ///< of the latest motions with a known scale
  RunningMedian guessed_;    ///< scale, from the first motions of a new group
  double guess_s_ = 0;
};

}  // namespace odograph::slant_scale
