// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "sdk/host/localizer/localizer.hpp"

namespace odograph {

/// Steps: they move the track where nothing else does; otherwise they are compared with the front-end.
class StepUpdate {
 public:
  struct Parameters {
    double factor_sigma = 0.10;        ///< walker's log factor: spread of ten walkers (docs/accuracy.md)
    double factor_steps = 200;         ///< steps, decay constant of the estimated factor; judgement
    double own_sigma = 0.06;           ///< of a step's length, relative, independent part: step/odograph's README
    double min_sigma = 0.01;           ///< lower clamp of it; empirical
    double correlation = 10;           ///< steps over which this error is correlated, beside odometry
    double odometry_sigma = 0.02;      ///< units, of a front-end's displacement over a step; empirical
    double min_moved = 0.1;            ///< units a step, below which the logarithm is meaningless; empirical
    double direction_rad = 0.10;       ///< rad, of one step's direction: a hand sways
    double loose_direction_rad = 0.5;  ///< rad, the same with the phone swinging or in a pocket
    double heading_sigma_rad = 0.3;    ///< rad between the phone's axis and the walk at the start; judgement
    double heading_walk = 0.02;        ///< rad per square root of a step; judgement
    int settle_steps = 6;  ///< steps after a change of carrying position, during which the estimated step heading is
                           ///< invalid; judgement, 3 s
    double climb_sigma_mps = 0.25;  ///< m/s vertically while steps move the track: stairs rise by 0.25 to 0.35
    double climb_s = 4;             ///< s, its correlation time: a flight takes 5 to 12 s; judgement, 2 to 8
    int max_rejected = 4;  ///< consecutive rejections, after which step heading and the factor, or the scale of a
                           ///< front-end that states none, lose confidence
  };

  /// Initialises the states at the start of a track.
  void reset(Localizer& localizer);

  /// Propagates walker and carrying position by one step. `learns`: the estimated factor decays slowly.
  void propagate(Localizer& localizer, const odo_step& step, bool learns);
  /// Displacement of the body by a step in n, m, and its own noise, m^2.
  struct Stride {
    Eigen::Vector3d d_n;
    Eigen::Matrix3d noise;
  };
  /// Moves the body by a fraction of the step, along the phone's own direction if the step has no heading. Eq. (5).
  Stride apply_step(Localizer& localizer, const odo_step& step, double share, double phone_heading_rad) const;
  /// Compares a step with the front-end's displacement over it, up to scale, in o. `variance` of that displacement
  /// covers parts without tracking. `metric`: the step does not update the scale.
  UpdateResult compare(Localizer& localizer, const odo_step& step, const Eigen::Vector3d& moved_o, double variance,
                       bool metric);
  bool any() const { return any_; }

 private:
  double own_sigma(const odo_step& step) const;
  double direction_sigma(const odo_step& step) const;

  Parameters p_;
  bool any_ = false, loose_ = false;
  int rejected_ = 0;  // consecutive
  int settling_ = 0;  // steps until the phone has settled in its new carrying position
};

}  // namespace odograph
