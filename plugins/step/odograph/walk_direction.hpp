// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace odograph::steps {

/// Walking direction relative to the phone's forward axis, from the surge of each step. The body surges along its path
/// a good quarter of the step period before it is pushed up, so the horizontal acceleration at that phase lead over the
/// vertical one points forward (StepFinder, FoundStep::surge). Angles are about the vertical, from the phone's forward
/// axis, and stay valid while the phone does not move relative to the body.
class WalkDirection {
 public:
  struct Parameters {
    double steps = 12;            ///< averaging length of the surges: a few strides longer than turning takes
    double min_sigma_rad = 0.12;  ///< lower bound for any number of steps: RIDI's walkers (README)
  };
  WalkDirection() : WalkDirection(Parameters{}) {}
  explicit WalkDirection(const Parameters& parameters) : p_(parameters) {}

  /// Adds a step's surge in n, and the heading of the phone's forward axis at that time.
  void add(const Eigen::Vector2d& surge_n, double phone_heading_rad);
  /// Heading of the walk minus that of the phone's forward axis.
  double offset_rad() const;
  /// Its sigma; pi if unknown.
  double sigma_rad() const;
  void reset() { *this = WalkDirection(p_); }

 private:
  Parameters p_;
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
  double weights_ = 0, squared_weights_ = 0;  ///< sums of the surges' lengths and of their squares
};

}  // namespace odograph::steps
