// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/evaluation/composed_motions.hpp"

namespace odograph {

/// Detection of standstill from the true path: the displacement over `window_s` stays below `speed_mps` for at least
/// `min_s`.
struct StandingParameters {
  double window_s = 1.0;    ///< s, longer than a step, so that body sway does not count as walking
  double speed_mps = 0.25;  ///< m/s; the slowest gait of the phone profile is 0.5, a phone turned at arm's length 0.22
  double min_s = 2.0;       ///< s, the shortest stop at a kerb
};

struct Stop {
  int64_t from_ns, to_ns;
};
std::vector<Stop> stops_of(const StampedPoses& truth, const StandingParameters& parameters);

/// Effect of a stop on the odometry.
struct StopFigures {
  Stop stop;
  bool new_group = false;  ///< the scale group changed between the part before and the part after the stop
  /// Ratio of the odometry's displacement to the true one over the last metres before the stop and the first after it;
  /// 0 if either part is incomplete or its displacement too small. Up to scale, so also valid for odometries without
  /// metric scale.
  double scale_before = 0, scale_after = 0;
  double drift_m = 0;  ///< error of the displacement over the stop, metric poses only, otherwise 0
  bool measured() const { return !new_group && scale_before > 0 && scale_after > 0; }
  double jump() const { return scale_after / scale_before - 1; }
};

/// Consecutive metric poses of one scale group during which the odometry states that it is tracking.
struct TrackedStretch {
  int64_t from_ns, to_ns;
  double path_m;  ///< true
  double rmse_m;  ///< after SE(3) alignment of this stretch alone
};

/// A part of the path within one scale group.
struct ScaleWindow {
  int64_t from_ns, to_ns;
  double path_m;     ///< true, from the trajectory's start to the middle of the window
  double log_scale;  ///< of the ratio of the odometry's metric displacement to the true one
  double sigma;      ///< stated scale uncertainty there, relative; 0: none
};

struct VoFigureParameters {
  StandingParameters standing;
  double stop_stretch_m = 10;  ///< m of the true path before and after a stop
  /// m between the ends of a scale window. Path length would not do: for a walker who turns back, the displacement
  /// vanishes and a position error would count as a scale error.
  double window_m = 5;
  double min_straight = 0.25;    ///< displacement over path length beside a stop; below it, the scale is not observable
  double min_tracked_m = 5;      ///< m of the true path, minimum length of a tracked stretch for a relative error
  double confident_sigmas = 3;   ///< beyond it, the odometry's scale was confidently wrong
  double first_motion_m = 0.05;  ///< m from the first position, at which the camera has started to move
  double largest_gap_s = 0.25;   ///< s, true poses further apart are not interpolated
};

/// Evaluation of a visual odometry's motions against a recording's frames and true camera poses, without a host.
struct VoFigures {
  size_t frames = 0, groups = 0, holes = 0;
  double placed_share = 0;         ///< frames with a displacement, not lost
  double metric_share = 0;         ///< frames with metric scale
  double before_metric_share = 0;  ///< frames placed without metric scale before it became available
  double longest_group_share = 0;  ///< frames of the longest scale group
  /// s from the first frame, and from the camera's first motion, to the first metric motion; NaN: never.
  double start_s, start_from_motion_s;

  // Metric poses against the true ones; NaN if there are none.
  double path_m = 0;      ///< true, of the frames with a metric pose
  double own_path_m = 0;  ///< the odometry's own, of all metric poses
  double se3_rmse_m, sim3_rmse_m;
  double yaw_rmse_m;  ///< after yaw alignment with the stated gravity
  double scale;       ///< factor of the Sim(3) alignment; 1 is correct
  std::vector<StopFigures> stops;
  std::vector<ScaleWindow> windows;
  std::vector<TrackedStretch> tracked;
  double worst_tracked;         ///< of the tracked stretches, error over path; NaN: none
  double worst_jump;            ///< of the measured stops, absolute, relative; NaN: none
  double standing_drift_m_min;  ///< over all stops with metric poses; NaN: none
  double overconfident_share;   ///< of the windows' time; NaN: no window with a sigma
  double scale_nees;            ///< mean of (log scale / sigma)^2 over the windows; NaN: none
};

/// `emitted_ns`: for each motion, the time of the input after which it was emitted. `frames_ns`: in order. All on one
/// clock. `truth`: the camera's, in time order; the figure after yaw alignment requires a vertical z axis (up or down).
VoFigures vo_figures(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions,
                     const std::vector<int64_t>& emitted_ns, const std::vector<int64_t>& frames_ns,
                     const VoFigureParameters& parameters = {});

}  // namespace odograph
