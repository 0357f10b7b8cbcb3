// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <odograph/types.h>

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

constexpr double kLargestTruthGap_s = 0.5;  ///< between true poses that one is interpolated from

/// Whether poses err by as much as their covariances say, after the first of them was laid on the truth: position and
/// heading are known from there.
struct PoseConsistency {
  size_t poses = 0;  ///< with a truth; below three of them nothing else is there
  double path_m = 0;
  double ape_m = 0;        ///< rms after the rotation about the vertical and the shift that fit best
  double scale_error = 0;  ///< of the Sim(3) alignment
  /// Error squared over its covariance per degree of freedom, mean; 1 is consistent.
  double position_nees = 0, heading_nees = 0;
  double position_beyond_s = 0, heading_beyond_s = 0;  ///< the longest time beyond three sigmas without a break
};
PoseConsistency pose_consistency(const std::vector<odo_pose>& poses, const Trajectory& truth);

/// Error squared over its covariance, of a position in the plane: chi-square with two degrees of freedom.
double horizontal_nees(const Eigen::Vector3d& error_n, const double covariance_n[9]);

}  // namespace odograph
