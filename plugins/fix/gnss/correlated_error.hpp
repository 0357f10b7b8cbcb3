// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace odograph::gnss {

/// Temporal correlation of a receiver's error. Between buildings the error persists for tens of seconds, and jumps by
/// tens of metres when the signal path changes. An estimator that treats positions as independent converges to the
/// error within a few seconds. Does not allocate.
///
/// A first-order Gauss-Markov error of variance s^2 and time constant tau, sampled at intervals dt, carries the same
/// information about a constant as white errors of variance s^2 coth(dt / (2 tau)). A jump is detected against the
/// walked path: the change of (receiver minus path) within a few seconds exceeds what the process and the path explain.
/// The jump becomes a bias, which is subtracted and decays with its own time constant, so that a jump back to the truth
/// removes it.
class CorrelatedError {
 public:
  struct Parameters {
    double correlation_s = 20;  ///< tau
    double bias_s = 60;         ///< time constant with which a jump's bias decays; reflections last about a minute
    double path_error = 0.15;   ///< of the path's length, 1 sigma, in addition to its heading's
    double gate_sigma = 4;      ///< of the change, above which it is a jump
    // Empirical, not tuned:
    double correction_m = 5;        ///< a path that moves by this much at once was corrected, not walked
    double longest_s = 10;          ///< since the last position: beyond it a change is not a jump
    double own_noise_m = 1;         ///< receiver noise of two positions, 0.7 m each
    double max_heading_rad = 2;     ///< sigma of the path's heading above which the heading is unknown
    double decay_sigma_part = 0.5;  ///< of a bias: its sigma while it decays
  };
  struct Corrected {
    Eigen::Vector2d position_m;  ///< of the receiver, bias removed
    double sigma_m;              ///< sigma that independent positions need to carry the same information
    bool jumped;
  };
  explicit CorrelatedError(const Parameters& parameters) : p_(parameters) {}

  /// The walked path (north, east; m; any origin) and its heading's standard deviation in rad.
  void on_path(int64_t t_ns, const Eigen::Vector2d& path_m, double heading_sigma_rad);
  /// A position (north, east; m; any common origin) with the receiver's own standard deviation.
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
