// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace odograph::steps {

/// Where a walker goes, against the phone's own forward axis, from each step's surge: with every step the body surges
/// along its path, a good quarter of the step's period before it is pushed up, so the horizontal acceleration that
/// leads the vertical one by that much points ahead (StepFinder, FoundStep::surge). Angles are about the vertical, and
/// counted from where the phone's forward axis points; so they last while the phone stays in its place.
class WalkDirection {
 public:
  struct Parameters {
    double steps = 12;            ///< over which surges are averaged: a few strides more than it takes to turn
    double min_sigma_rad = 0.12;  ///< that no number of steps makes smaller: RIDI's walkers (README)
  };
  WalkDirection() : WalkDirection(Parameters{}) {}
  explicit WalkDirection(const Parameters& parameters) : p_(parameters) {}

  /// A step's surge in n, and the heading of the phone's forward axis meanwhile.
  void add(const Eigen::Vector2d& surge_n, double phone_heading_rad);
  /// Of the walk, less that of the phone's forward axis.
  double offset_rad() const;
  /// Of that; pi where nothing is known.
  double sigma_rad() const;
  void reset() { *this = WalkDirection(p_); }

 private:
  Parameters p_;
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
  double weights_ = 0, squared_weights_ = 0;  ///< of the surges: their lengths, and the squares
};

}  // namespace odograph::steps
