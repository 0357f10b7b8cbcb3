// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "sdk/host/localizer/localizer.hpp"

namespace odograph {

/// Steps: as the motion itself where nothing else moves the track, otherwise compared with the front-end's.
class StepUpdate {
 public:
  struct Parameters {
    double factor_sigma = 0.10;      ///< of the walker's log factor: ten walkers differ so (docs/accuracy.md)
    double factor_steps = 200;       ///< steps over which what was learnt of a walker is forgotten; judgement
    double own_sigma = 0.06;         ///< of a step's length, relative, its own: step/odograph's README
    double min_sigma = 0.01;         ///< of it: none is stated better; by hand
    double correlation = 10;         ///< steps whose own error is one error, beside odometry
    double odometry_sigma = 0.02;    ///< units, of a front-end's displacement over a step; by hand
    double min_moved = 0.1;          ///< units a step, below which its logarithm means nothing; by hand
    double across_rad = 0.10;        ///< rad of one step's direction: a hand sways
    double loose_across_rad = 0.5;   ///< rad, the same with the phone swung or in a pocket
    double heading_sigma_rad = 0.3;  ///< rad between the phone's axis and the walk at the start; judgement
    double heading_walk = 0.02;      ///< rad for the root of a step; judgement
    int settle_steps = 6;           ///< after the phone is put elsewhere, until it lies there: its heading is anybody's
                                    ///< guess then, whatever was learnt on the way; judgement, 3 s
    double climb_sigma_mps = 0.25;  ///< m/s up or down where steps carry: stairs lift by 0.25 to 0.35
    double climb_s = 4;             ///< s for which that stays alike: a flight takes 5 to 12 s; judgement, 2 to 8
    int max_rejected = 4;           ///< in a row, until the heading is doubted, and the factor, or the scale of a
                                    ///< front-end that states none
  };

  /// At the start of a track.
  void reset(Localizer& localizer);

  /// The walker and how the phone is held have changed by a step. `learns`: what was learnt of him is forgotten slowly.
  void go_on(Localizer& localizer, const odo_step& step, bool learns);
  /// What a step has moved the body by in n, m, and its own noise, m^2.
  struct Stride {
    Eigen::Vector3d d_n;
    Eigen::Matrix3d noise;
  };
  /// Moves the body by a share of the step, by the phone's own direction where the step has none. Eq. (5).
  Stride carry(Localizer& localizer, const odo_step& step, double share, double phone_heading_rad) const;
  /// Compared with what the front-end moved meanwhile, up to scale, in o, with its variance, which counts where it saw
  /// nothing and went on by inertia. `metric`: its scale is not for steps to say.
  UpdateResult compare(Localizer& localizer, const odo_step& step, const Eigen::Vector3d& moved_o, double variance,
                       bool metric);
  bool any() const { return any_; }

 private:
  double own_sigma(const odo_step& step) const;
  double direction_sigma(const odo_step& step) const;

  Parameters p_;
  bool any_ = false, loose_ = false;
  int rejected_ = 0;  // in a row
  int settling_ = 0;  // steps, until the phone lies where it was put
};

}  // namespace odograph
