// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <array>
#include <deque>
#include <optional>

#include <Eigen/Core>

namespace odograph::slant_scale {

struct Scale {
  double scale, sigma;
};

/// Scale from slant distances to known roof points: eq. (4) to (6) of Gakne & O'Keefe 2018.
///
/// Eq. (5) divides the slant distance by ||P_3DBM - P_VO||, that is, one length in metres by the same one of the
/// odometry. Here the length is the distance between two fixes: in metres the difference of the slant vectors to the
/// roof points, P_3DBM = X - d_slant u; up to scale the sum of eq. (6)'s displacements, with their directions. The
/// scale is the robust least-squares line through the fixes of the window, so that no single pair of them rules.
class SlantScale {
 public:
  /// Chosen by hand, and not tuned.
  struct Parameters {
    double huber = 1.5;         ///< standard deviations of a place, from where on it counts linearly
    double leap = 0.7;          ///< of the scale's logarithm within a window, a factor of two: another place, alike
    int insist = 20;            ///< fixes in a row that say so: then they are right
    double guess = 0.3;         ///< relative sigma of a scale that rests on the speed before
    double guess_s = 1;         ///< of motions, from which it is made
    double standing_mps = 0.5;  ///< slower, the speed before says nothing
  };

  /// `scale_drift`: by how much of itself the odometry's scale changes within a window.
  SlantScale(double window_s, double min_displacement_m, double scale_drift)
      : window_s_(window_s), min_displacement_m_(min_displacement_m), scale_drift_(scale_drift) {}

  /// A motion's displacement in n, up to scale. A new group forgets what had the old one's scale, and
  /// begins with the speed that the old one ended with.
  void add_motion(int64_t from_ns, int64_t t_ns, const Eigen::Vector3d& d_n, uint32_t group);
  /// The vehicle's place by the city model, m, and the variance of one axis, m^2.
  void add_place(int64_t t_ns, const Eigen::Vector2d& p_n, double variance);
  const std::optional<Scale>& scale() const { return scale_; }

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

  /// Median of the latest values: a picture misunderstood makes one motion of any length.
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
  int leaps_ = 0;
  bool known_ = false;       ///< by fixes, not by the speed before
  RunningMedian speed_mps_;  ///< of the latest motions whose scale was known
  RunningMedian guessed_;    ///< scale, by the first motions of a new group
  double guess_s_ = 0;
};

/// Eq. (4) to (6) and Algorithm 1 letter for letter: s_g = d_slant / ||P_3DBM - P_VO||, P_VO being the previous
/// position by the odometry alone, up to scale, from the same origin. What that is worth: docs/slant_distance.md.
class LiteralScale {
 public:
  /// A motion's displacement in n, up to scale: eq. (6)'s positions. A new group begins where the last place was.
  void add_motion(const Eigen::Vector3d& d_n, uint32_t group);
  /// The place by the city model and the slant distance from there, m.
  void add_place(const Eigen::Vector3d& p_n, double slant_distance_m);
  /// Nothing before the first place.
  std::optional<double> scale() const { return scale_; }

 private:
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero(), before_ = Eigen::Vector3d::Zero(),
                  last_place_ = Eigen::Vector3d::Zero();
  std::optional<uint32_t> group_;
  std::optional<double> scale_;
};

}  // namespace odograph::slant_scale
