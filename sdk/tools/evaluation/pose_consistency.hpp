// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <odograph/types.h>

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

constexpr double kLargestTruthGap_s = 0.5;  ///< maximum spacing of true poses for interpolation

/// Consistency of pose errors with their covariances, after the first pose is aligned with the truth in position and
/// heading.
struct PoseConsistency {
  size_t poses = 0;  ///< with truth; the other figures need at least three
  double path_m = 0;
  double ape_m = 0;        ///< rms after yaw alignment
  double scale_error = 0;  ///< of the Sim(3) alignment
  /// Normalised error squared per degree of freedom, mean; 1 is consistent.
  double position_nees = 0, heading_nees = 0;
  double position_beyond_s = 0, heading_beyond_s = 0;  ///< longest continuous time beyond three sigma
};
PoseConsistency pose_consistency(const std::vector<odo_pose>& poses, const StampedPoses& truth);

/// Normalised error squared of a horizontal position: chi-square with two degrees of freedom.
double horizontal_nees(const Eigen::Vector3d& error_n, const double covariance_n[9]);

}  // namespace odograph
