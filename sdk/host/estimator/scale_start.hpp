// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "sdk/host/estimator/inertial_scale.hpp"

namespace odograph::inertial {

/// The first scale of a group of motions whose scale nobody knows, from steps and from inertia, whichever comes first.
class ScaleStart {
 public:
  explicit ScaleStart(const Parameters& parameters) : p_(parameters) {}

  struct Known {
    double log_scale, variance;
    double steps_share;  ///< weight of the steps in it, 0 to 1
  };

  void restart();
  /// The odometry's position since the group began, up to scale, in n.
  void add_motion(int64_t t_ns, const Eigen::Vector3d& y_n) { path_.add(t_ns, y_n); }
  void add_window(const WindowScale& window);
  /// False where the odometry does not cover the step.
  bool add_step(int64_t start_ns, int64_t end_ns, double length_m);
  /// Once it is good enough. Log of the walker's factor and its variance, as far as they are known.
  std::optional<Known> known(double log_factor, double factor_variance) const;
  /// The odometry's position then, interpolated; nothing outside of what is kept.
  std::optional<Eigen::Vector3d> at(int64_t t_ns) const { return path_.at(t_ns); }

 private:
  Parameters p_;
  TimedPositions path_;
  double steps_m_ = 0, steps_displacement_ = 0;
  int steps_ = 0;
  double information_ = 0, weighted_ = 0;  // of the inverse scale
};

}  // namespace odograph::inertial
