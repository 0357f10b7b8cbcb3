// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

/// Rotates (yaw) and translates the track onto the truth over its first metres, as for an app with a known start.
StampedPoses aligned_at_start(const StampedPoses& truth, const StampedPoses& track, double over_m);

/// Rotates (yaw) and translates the track onto the truth's pose at the end of its first metres: the effect of a fix of
/// position and heading, as from a known object.
StampedPoses aligned_by_pose(const StampedPoses& truth, const StampedPoses& track, double after_m);

/// Scales the track to the true length over the truth's first metres, as a car knows it from its wheels.
StampedPoses scaled_by_start(const StampedPoses& truth, const StampedPoses& track, double over_m);

/// Rotates the track so that its first orientation is the true one: a camera alone does not observe the vertical.
StampedPoses rotated_onto_first(const StampedPoses& truth, const StampedPoses& track);

/// Rotation about the vertical from the estimate to the truth, rad, from -pi to pi.
double yaw_error(const Eigen::Quaterniond& estimate, const Eigen::Quaterniond& truth);

/// A rotation about the vertical and a translation, from n of a track to n of the truth.
struct YawAlignment {
  double yaw_rad = 0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();

  Eigen::Vector3d on_truth(const Eigen::Vector3d& p) const;
  Eigen::Vector3d on_track(const Eigen::Vector3d& p) const;
  double yaw_error(const Eigen::Quaterniond& estimate, const Eigen::Quaterniond& truth) const;
};
/// Alignment of a pose of the track with the true one.
YawAlignment yaw_alignment(const StampedPose& estimate, const StampedPose& truth);

/// Horizontal distance of the track from the truth at each true pose.
std::vector<double> horizontal_errors(const StampedPoses& truth, const StampedPoses& track);
double horizontal_error(const StampedPoses& truth, const StampedPoses& track, int64_t t_ns);

/// Errors of a track at each true pose, north, east and horizontal; and between consecutive ones, the error of the
/// displacement's length.
struct PositionErrors {
  std::vector<double> north_m, east_m, horizontal_m, displacement_m;
};
PositionErrors position_errors(const StampedPoses& truth, const StampedPoses& track);

}  // namespace odograph
