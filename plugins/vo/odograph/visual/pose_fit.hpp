// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/vo/odograph/visual/parameters.hpp"

namespace odograph::vo {

/// A point of the map and where the picture has it.
struct PointSeen {
  Eigen::Vector4d X_w;                ///< homogeneous: a point far away has a small last component
  Eigen::Vector2d seen;               ///< normalized image coordinates
  Eigen::Vector3d anchor_w;           ///< where the point's inverse depth counts from
  double inverse_depth_variance = 0;  ///< what is not known of it moves the point along its epipolar line
};

/// What is known of the rotation before looking.
struct RotationPrior {
  Eigen::Quaterniond q_w_c;
  double sigma_rad;
};

struct FittedPose {
  Eigen::Isometry3d T_w_c;
  Eigen::Matrix<double, 6, 6> covariance;  ///< of (rotation on the right, position in w)
  std::vector<char> inliers;
  int count = 0;
  double rms = 0;  ///< of the inliers' reprojection errors, normalized coordinates
};

/// The pose that sees the points where they are seen: Gauss-Newton with a redescending loss (Geman-McClure) whose scale
/// shrinks from `loose` to `sigma`, both in normalized coordinates. Nothing when the equations are singular.
std::optional<FittedPose> fit_pose(const std::vector<PointSeen>& points, const Eigen::Isometry3d& start, double sigma,
                                   double loose, const std::optional<RotationPrior>& prior,
                                   const PoseFitParameters& p = {});

}  // namespace odograph::vo
