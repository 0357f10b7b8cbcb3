// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/fusion/odometry.hpp"
#include "sdk/math/ring.hpp"

namespace odograph {

/// Walker and carrying position in the filter: the step factor and the walking direction.
class StepModel {
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
    /// Step intervals after the report of a step, beyond which the next is overdue and the walker stands. Intervals of
    /// a walk vary by a tenth; judgement.
    double due_intervals = 1.25;
    double longest_s = 2;  ///< s, of a step that is followed by another: the slowest cadence found is 0.8 Hz
    int max_rejected = 4;  ///< consecutive rejections, after which step heading and the factor, or the scale of a
                           ///< front-end that states none, lose confidence
  };

  /// Initialises the states at the start of a track.
  void reset(PoseFilter& filter);

  /// Propagates walker and carrying position by one step. `learns`: the estimated factor decays slowly.
  void propagate(PoseFilter& filter, const odo_step& step, bool learns);
  /// Displacement of the body by a step in n, m, and its own noise, m^2.
  struct Stride {
    Eigen::Vector3d d_n;
    Eigen::Matrix3d noise;
  };
  /// Moves the body by a fraction of the step, along the phone's own direction if the step has no heading. Eq. (5).
  Stride apply_step(PoseFilter& filter, const odo_step& step, double share, double phone_heading_rad) const;
  /// Compares a step with the front-end's displacement over it, up to scale, in o. `variance` of that displacement
  /// covers parts without tracking. `metric`: the step does not update the scale.
  UpdateResult compare(PoseFilter& filter, const odo_step& step, const Eigen::Vector3d& moved_o, double variance,
                       bool metric);
  bool any() const { return any_; }
  bool is_stride(int64_t interval_ns) const { return seconds(interval_ns) < p_.longest_s; }
  /// Latest time at which the next step would be reported, if it takes that interval.
  int64_t due_ns(const odo_step& step, int64_t interval_ns) const {
    return saturating_sum(step.header.t_ns, nanoseconds(p_.due_intervals * seconds(interval_ns)));
  }

 private:
  double own_sigma(const odo_step& step) const;
  double direction_sigma(const odo_step& step) const;

  Parameters p_;
  bool any_ = false, loose_ = false;
  int rejected_ = 0;  // consecutive
  int settling_ = 0;  // steps until the phone has settled in its new carrying position
};

/// A walker's steps: compared with the front-end where it moved meanwhile; otherwise they move the track. Each waits
/// until the front-end has covered its time or has gone silent.
class Steps {
 public:
  /// What steps did to the track.
  struct Moved {
    Eigen::Vector3d d_n = Eigen::Vector3d::Zero();  ///< m
    bool lead = false;                              ///< they have moved its end, not only a part before it
  };

  Steps(FusionState& state, Odometry& odometry) : state_(state), odometry_(odometry) {}
  /// At the start of a track.
  void start() { model_.reset(state_.filter); }
  void add(const odo_step& step);
  /// Processes the steps whose time is settled by now.
  Moved settle(int64_t now_ns, Outputs& out);
  /// Moves the track by a fraction of a step.
  void apply(const odo_step& step, double share, Moved& moved);

  bool any() const { return model_.any(); }
  Instant moved() const { return moved_; }  ///< end of the newest step that moved the track

 private:
  void pop();
  void walk_on(const odo_step& step, const Eigen::Vector3d& moved_o, Instant before);
  void estimate_scale(Outputs& out);
  void compare(const odo_step& step, Outputs& out);

  FusionState& state_;
  Odometry& odometry_;
  StepModel model_;
  Ring<odo_step, 16> waiting_;
  size_t count_ = 0;     // of waiting steps
  size_t compared_ = 0;  // of these, the oldest, already compared with an unscaled front-end
  Instant moved_;
  int64_t interval_ns_ = 0;                            // of the newest step that moved the track's end
  Eigen::Vector3d moved_o_ = Eigen::Vector3d::Zero();  // by it
};

}  // namespace odograph
