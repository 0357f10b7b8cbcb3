// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/vo/odograph/visual/parameters.hpp"

namespace odograph::vo {

/// A point of the map and its observation.
struct PointSeen {
  Eigen::Vector4d X_w;                ///< homogeneous: a distant point has a small last component
  Eigen::Vector2d seen;               ///< normalized image coordinates
  Eigen::Vector3d anchor_w;           ///< origin of the inverse depth
  double inverse_depth_variance = 0;  ///< moves the point along its epipolar line
};

/// Prior of the rotation.
struct RotationPrior {
  Eigen::Quaterniond q_w_c;
  double sigma_rad;
};

struct FittedPose {
  Eigen::Isometry3d T_w_c;
  Eigen::Matrix<double, 6, 6> covariance;  ///< of (right perturbation of the rotation, position in w)
  std::vector<char> inliers;
  int count = 0;
  double rms = 0;  ///< of the inliers' reprojection errors, normalized coordinates
};

/// Pose from 2D-3D correspondences: Gauss-Newton with a redescending loss (Geman-McClure) whose scale decreases from
/// `loose` to `sigma`, both in normalized coordinates. Nothing if the equations are singular.
std::optional<FittedPose> fit_pose(const std::vector<PointSeen>& points, const Eigen::Isometry3d& start, double sigma,
                                   double loose, const std::optional<RotationPrior>& prior,
                                   const PoseFitParameters& p = {});

}  // namespace odograph::vo
