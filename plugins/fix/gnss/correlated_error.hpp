// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace odograph::gnss {

/// What a receiver's error does from one position to the next: between houses it stays alike for tens of seconds, and
/// jumps by tens of metres when the path of a signal changes. An estimator that takes positions for independent would
/// believe the error after a few seconds. No allocation.
///
/// A first-order Gauss-Markov error of variance s^2 and time constant tau, sampled each dt, tells as much of a constant
/// as white errors of variance s^2 coth(dt / (2 tau)). A jump is seen against what is known of the walker's path: the
/// change of (receiver minus path) within a few seconds is larger than the process and the path explain. It is kept as
/// a bias, which is taken off and forgotten with its own time constant, so that a jump back to the truth ends there
/// too.
class CorrelatedError {
 public:
  struct Parameters {
    double correlation_s = 20;  ///< tau
    double bias_s = 60;        ///< time constant with which a jump's bias is forgotten; reflections last a minute or so
    double path_error = 0.15;  ///< of the path's length, 1 sigma, beside its heading's
    double gate_sigma = 4;     ///< of the change, above which it is a jump
    // What follows was chosen by hand, and not tuned.
    double correction_m = 5;      ///< a path that moves so far at once was corrected, not walked
    double longest_s = 10;        ///< since the last position: beyond, a change is no jump
    double own_noise_m = 1;       ///< a receiver's own noise, 0.7 m twice
    double max_heading_rad = 2;   ///< of the path's heading: a worse one is any
    double forgotten_part = 0.5;  ///< of a bias, as its sigma while it is forgotten
  };
  struct Corrected {
    Eigen::Vector2d position_m;  ///< the receiver's less the bias
    double sigma_m;              ///< with which independent positions would tell as much
    bool jumped;
  };
  explicit CorrelatedError(const Parameters& parameters) : p_(parameters) {}

  /// The path as it is known so far (north, east; m; any origin), its heading's standard deviation in rad.
  void on_path(int64_t t_ns, const Eigen::Vector2d& path_m, double heading_sigma_rad);
  /// A position (north, east; m; any origin, the same for all) with the receiver's own standard deviation.
  Corrected on_position(int64_t t_ns, const Eigen::Vector2d& position_m, double sigma_m);
  const Eigen::Vector2d& bias_m() const { return bias_; }
  void reset() { *this = CorrelatedError(p_); }

 private:
  struct Seen {
    int64_t t_ns = 0;
    Eigen::Vector2d difference = Eigen::Vector2d::Zero();  ///< corrected position minus path
    double walked_m = 0;
  };
  Parameters p_;
  Eigen::Vector2d path_ = Eigen::Vector2d::Zero(), bias_ = Eigen::Vector2d::Zero();
  double walked_m_ = 0, heading_sigma_rad_ = 3.2, bias_variance_m2_ = 0;
  bool has_path_ = false, has_last_ = false;
  Seen last_;
  int64_t last_ns_ = 0;
};

}  // namespace odograph::gnss
