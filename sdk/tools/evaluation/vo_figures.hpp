// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/evaluation/composed_motions.hpp"

namespace odograph {

/// When a camera stands, by its true path: `speed_mps` is not reached by the displacement over `window_s`, for at least
/// `min_s`.
struct StandingParameters {
  double window_s = 1.0;    ///< s, longer than a step, so that the trunk's sway is no walk
  double speed_mps = 0.25;  ///< m/s; the slowest gait of the phone profile is 0.5, a phone turned at arm's length 0.22
  double min_s = 2.0;       ///< s, the shortest stop at a kerb
};

struct Stop {
  int64_t from_ns, to_ns;
};
std::vector<Stop> stops_of(const Trajectory& truth, const StandingParameters& parameters);

/// What a stop did to the odometry.
struct StopFigures {
  Stop stop;
  bool new_group = false;  ///< the scale group changed somewhere between the stretch before and the stretch after
  /// The odometry's displacement by the true one, over the last metres before the stop and the first after it; 0 where
  /// either stretch is not whole or hardly leads anywhere. Up to scale, so of odometries without a metre too.
  double scale_before = 0, scale_after = 0;
  double drift_m = 0;  ///< error of the displacement between beginning and end of the stop; metric poses only, else 0
  bool measured() const { return !new_group && scale_before > 0 && scale_after > 0; }
  double jump() const { return scale_after / scale_before - 1; }
};

/// Metric poses of one scale group without a break in which the odometry says that it follows the world.
struct TrackedStretch {
  int64_t from_ns, to_ns;
  double path_m;  ///< true
  double rmse_m;  ///< after SE(3) alignment of this stretch alone
};

/// One stretch of the path within one scale group.
struct ScaleWindow {
  int64_t from_ns, to_ns;
  double path_m;     ///< true, from the trajectory's beginning to the stretch's middle
  double log_scale;  ///< of the odometry's metric displacement by the true one
  double sigma;      ///< what the odometry said of its scale there, relative; 0: nothing
};

struct VoFigureParameters {
  StandingParameters standing;
  double stop_stretch_m = 10;  ///< m of the true path before and after a stop
  /// m that a scale window's ends lie apart. Of its path would not do: who turns about ends where he began, and the
  /// error of his place is then taken for one of the scale.
  double window_m = 5;
  double min_straight = 0.25;    ///< of a stretch beside a stop, its displacement by its length: less tells no scale
  double min_tracked_m = 5;      ///< m of the true path of a tracked stretch that has an error worth a percentage
  double certain_sigmas = 3;     ///< beyond it the odometry was wrongly certain of its scale
  double first_motion_m = 0.05;  ///< m from the first place: the camera has begun to move
  double largest_gap_s = 0.25;   ///< s, true poses further apart are not interpolated
};

/// What a recording's frames, its true camera poses and a visual odometry's motions come to, without any host.
struct VoFigures {
  size_t frames = 0, groups = 0, holes = 0;
  double placed_share = 0;         ///< frames with a displacement, not lost
  double metric_share = 0;         ///< frames in metres
  double before_metric_share = 0;  ///< frames placed without a metre while they waited for one that came
  double longest_group_share = 0;  ///< frames of the longest scale group
  /// s from the first frame, and from the camera's first motion, until the first metric motion came out; NaN: never.
  double start_s, start_from_motion_s;

  // Of the metric poses against the true ones; NaN where there are none.
  double path_m = 0;      ///< true, of the frames that have a metric pose
  double own_path_m = 0;  ///< the odometry's own, of all metric poses
  double se3_rmse_m, sim3_rmse_m;
  double
      yaw_rmse_m;  ///< after a rotation about the vertical and a shift, aligned with the gravity that the motions gave
  double scale;    ///< the factor that the Sim(3) alignment applies; 1 is right
  std::vector<StopFigures> stops;
  std::vector<ScaleWindow> windows;
  std::vector<TrackedStretch> tracked;
  double worst_tracked;          ///< of the tracked stretches, error by path; NaN: none
  double worst_jump;             ///< of the stops that were measured, absolute, relative; NaN: none was
  double standing_drift_m_min;   ///< over all stops with metric poses; NaN: none
  double wrongly_certain_share;  ///< of the windows' time; NaN: no window with a sigma
  double scale_nees;             ///< mean of (log scale / sigma)^2 over the windows; NaN: none
};

/// `known_ns`: for each motion the time of the input that it came out after. `frames_ns`: in order. All on one clock.
/// `truth` is the camera's, in order of time, in a frame whose z axis is vertical (up or down) where the figure after
/// yaw alignment is wanted.
VoFigures vo_figures(const Trajectory& truth, const std::vector<odo_vo_motion>& motions,
                     const std::vector<int64_t>& known_ns, const std::vector<int64_t>& frames_ns,
                     const VoFigureParameters& parameters = {});

/// The scale along the true path, by metres of it: of the metric windows as it is; where there are none that of the
/// displacements of `pairs` over window_m, by its median.
std::vector<std::pair<double, double>> scale_along(const VoFigures& figures, const Pairs& pairs,
                                                   const VoFigureParameters& parameters = {});

}  // namespace odograph
