// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::vio {

/// Online-calibrated parameters of a lens: log of the focal length (both axes), cx, cy, and the first two radial
/// coefficients.
inline constexpr int kLensStates = 5;
using LensVector = Eigen::Matrix<double, kLensStates, 1>;

void correct(CameraModel& lens, const LensVector& delta);

/// Maps a pixel of a frame taken with lens `taken_with` to the pixel that lens `in` would give, px.
Eigen::Vector2d change_lens(const Eigen::Vector2d& pixel, const CameraModel& taken_with, const CameraModel& in);

struct Projection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;  ///< derivative of the pixel by the point in c
  Eigen::Matrix<double, 2, kLensStates> by_lens;
};

/// Projects a point in front of the camera (z > 0), with derivatives.
Projection project(const CameraModel& lens, const Eigen::Vector3d& y);

}  // namespace odograph::vio
