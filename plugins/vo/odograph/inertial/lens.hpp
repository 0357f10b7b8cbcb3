// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::vio {

/// What is refined of a lens while running: log of the focal length (both), cx, cy, and the first two radial
/// coefficients.
inline constexpr int kLensStates = 5;
using LensVector = Eigen::Matrix<double, kLensStates, 1>;

void correct(CameraModel& lens, const LensVector& delta);

/// Where a pixel of a frame that `taken_with` took would lie in one that `in` had taken, px.
Eigen::Vector2d change_lens(const Eigen::Vector2d& pixel, const CameraModel& taken_with, const CameraModel& in);

struct Projection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;  ///< px by the point's coordinates in the camera
  Eigen::Matrix<double, 2, kLensStates> by_lens;
};

/// A point in front of the camera (z > 0) to its pixel, with derivatives.
Projection project(const CameraModel& lens, const Eigen::Vector3d& y);

}  // namespace odograph::vio
