// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sdk/tools/recording/trajectory.hpp"

namespace odograph {

/// Error statistics; definitions as in evo (Grupp, github.com/MichaelGrupp/evo).
struct Statistics {
  double rmse = 0, mean = 0, median = 0, std = 0, min = 0, max = 0, sse = 0;
  size_t n = 0;
};
Statistics statistics_of(std::vector<double> errors);
/// The percentile `p` (0 to 1) of the values, linear between ranks.
double percentile(std::vector<double> values, double p);
/// Fraction of errors that are smaller than the corresponding ones in the other list.
double part_below(const std::vector<double>& errors, const std::vector<double>& others);

enum class Alignment { none, first, yaw, se3, sim3 };
Result<Alignment> parse_alignment(const std::string& name);

/// Poses of both trajectories at common times: each pose of the shorter one with the pose of the other nearest in time,
/// if at most `max_difference_s` away (evo's association).
struct Pairs {
  StampedPoses reference, estimate;
};
Pairs associate(const StampedPoses& reference, const StampedPoses& estimate, double max_difference_s);

/// Aligns the estimate with the reference. none: unchanged. first: the first poses coincide. yaw: least squares over a
/// rotation about the vertical and a translation. se3, sim3: Umeyama 1991, without and with scale. `scale` receives the
/// factor applied.
StampedPoses align(const Pairs& pairs, Alignment alignment, double* scale);

/// The share of a scale error in the position error of an aligned estimate.
struct ScalePart {
  double scale = 1;  ///< the estimate's displacements over the reference's: 1.02 is 2 % too long
  double rms_m = 0;  ///< of the positions that remains with the reference's scale
};
/// The factor is the one of least squares about both centroids. Exact for estimates aligned by yaw or SE(3), whose best
/// rotation does not depend on the scale. None if the estimate does not move.
std::optional<ScalePart> scale_part(const StampedPoses& reference, const StampedPoses& aligned);

/// Absolute pose error: translation in m, rotation in rad.
struct PoseErrors {
  std::vector<double> translation_m, rotation_rad;
};
PoseErrors absolute_errors(const StampedPoses& reference, const StampedPoses& estimate);

/// Relative pose error over consecutive intervals of `delta` frames, or `delta` metres of the reference's path.
PoseErrors relative_errors(const StampedPoses& reference, const StampedPoses& estimate, double delta, bool metres);

/// Ratio of the displacements, estimate to reference, over windows of the path: (metres along the path, ratio).
std::vector<std::pair<double, double>> scale_along_path(const StampedPoses& reference, const StampedPoses& estimate,
                                                        double window_m);

/// The estimate with true displacement lengths: the remaining error is the one that no scale source can correct. With a
/// window of 0, each frame's displacement gets the true length; otherwise all displacements within a window of the true
/// path share one factor, the ratio of both displacements over it. Directions and orientations are the estimate's. A
/// frame without displacement does not move.
struct TrueLengths {
  StampedPoses track;
  std::vector<double> direction_error_rad;  ///< of each frame's displacement, in camera axes
  size_t without_motion = 0;                ///< frames that moved in truth but not in the estimate
};
TrueLengths with_true_lengths(const Pairs& pairs, double window_m);

/// Change of the estimate's scale within windows of the true path: for each window whose halves both have a
/// displacement, the ratio of the second half's scale (true displacement over the estimate's) to the first half's,
/// minus 1.
std::vector<double> scale_changes(const Pairs& pairs, double window_m);

/// Position at a time: linear between poses, constant before the first and after the last.
Eigen::Vector3d position_at(const StampedPoses& trajectory, int64_t t_ns);

/// Pose at a time, interpolated if its neighbours are at most `largest_gap_s` apart; none outside the trajectory.
std::optional<StampedPose> pose_at(const StampedPoses& trajectory, int64_t t_ns, double largest_gap_s);

/// Rotation about the vertical, rad, that fits the track to the waypoints within the first `metres` of their polyline
/// (at least one waypoint), both relative to the first waypoint.
double heading_offset(const StampedPoses& track, const std::vector<Waypoint>& waypoints, double metres);
/// Rotates the track about its position at the first waypoint, and translates that position to the waypoint.
StampedPoses align_to_waypoints(const StampedPoses& track, const std::vector<Waypoint>& waypoints, double yaw_rad);

struct WaypointErrors {
  double reference_m = 0;          // length of the polyline through the waypoints
  double estimate_m = 0;           // length of the track between the first and the last waypoint
  std::vector<double> position_m;  // horizontal, at each waypoint after the first
  double distance_error() const { return reference_m > 0 ? (estimate_m - reference_m) / reference_m : 0.0; }
};
WaypointErrors waypoint_errors(const StampedPoses& track, const std::vector<Waypoint>& waypoints);

/// Splits a position error into its causes: horizontal errors at each waypoint after the first, with the true heading
/// of each leg between waypoints, and with its true length. The heading of the second is fitted over the first
/// `metres`, as in heading_offset().
struct LegErrors {
  std::vector<double> true_headings_m, true_lengths_m;
  std::vector<double> heading_rad, length;  ///< remaining error per leg of 1 m or more: heading after a fit over all of
                                            ///< them, and estimated over true length minus 1
};
LegErrors leg_errors(const StampedPoses& track, const std::vector<Waypoint>& waypoints, double metres);

}  // namespace odograph
