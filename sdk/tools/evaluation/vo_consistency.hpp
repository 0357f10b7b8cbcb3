// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <odograph/types.h>

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

/// Squared errors of a visual odometry's motions normalised by their covariances, per degree of freedom, for each
/// motion with a covariance and a truth. Directions only of frames that moved 3 cm or more.
struct MotionConsistency {
  std::vector<double> rotation, direction;
};
MotionConsistency motion_consistency(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions);

/// Shape of a visual odometry's path, independent of its scale.
struct VoShape {
  double path_m = 0;                                 ///< true, of the frames that have a pose
  double ape_m = 0;                                  ///< rms after Sim(3)
  double end_per_frame_m = 0, end_per_window_m = 0;  ///< end-point error with true scale per frame, and per 10 m
  std::vector<double> scale_change;                  ///< within such windows, absolute, relative
  std::vector<double> rotation_rad;                  ///< error of each frame
  double rotation_nees = 0, direction_nees = 0;      ///< means of MotionConsistency
  double tracking_share = 0, lost_share = 0;         ///< of the motions, by their stated state
};
/// `pairs`: the true poses and those composed from the motions. With fewer than ten, everything but the shares is NaN.
VoShape vo_shape(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions, const Pairs& pairs);

}  // namespace odograph
