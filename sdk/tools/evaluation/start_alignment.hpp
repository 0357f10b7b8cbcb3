// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

/// Turned and shifted onto the truth over its first metres, as an app does that knows where it starts.
Trajectory started(const Trajectory& truth, const Trajectory& track, double over_m);

/// Turned and shifted onto the truth where its first metres end, by position and heading there: what a fix of both, as
/// a known object gives it, does for an app.
Trajectory started_by_pose(const Trajectory& truth, const Trajectory& track, double after_m);

/// The track with the true length over the truth's first metres, as a car knows it from its wheels when it pulls away.
Trajectory scaled_by_start(const Trajectory& truth, const Trajectory& track, double over_m);

/// Turned so that its first pose looks where the true one does: a camera alone does not know what is up.
Trajectory turned_onto_first(const Trajectory& truth, const Trajectory& track);

/// Rotation about the vertical from the estimate to the truth, rad, from -pi to pi.
double yaw_error(const Eigen::Quaterniond& estimate, const Eigen::Quaterniond& truth);

/// A rotation about the vertical and a shift, from n of a track to n of the truth.
struct YawAlignment {
  double yaw_rad = 0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();

  Eigen::Vector3d on_truth(const Eigen::Vector3d& p) const;
  Eigen::Vector3d on_track(const Eigen::Vector3d& p) const;
  double yaw_error(const Eigen::Quaterniond& estimate, const Eigen::Quaterniond& truth) const;
};
/// What brings a pose of the track onto the true one.
YawAlignment yaw_alignment(const StampedPose& estimate, const StampedPose& truth);

/// Horizontal distance of the track from the truth, at each of the truth's poses.
std::vector<double> horizontal_errors(const Trajectory& truth, const Trajectory& track);
double horizontal_error(const Trajectory& truth, const Trajectory& track, int64_t t_ns);

/// How far off a track is at each of the truth's poses: to the north, to the east, horizontally; and from each to the
/// next one how far its displacement's length is from the true one's.
struct PositionErrors {
  std::vector<double> north_m, east_m, horizontal_m, displacement_m;
};
PositionErrors position_errors(const Trajectory& truth, const Trajectory& track);

}  // namespace odograph
