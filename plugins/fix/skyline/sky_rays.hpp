// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::skyline {

/// Unit ray of a pixel; false beyond `farthest_rad` from the optical axis or where the lens's polynomial is not
/// monotonic.
bool ray_of(const CameraModel& camera, const Eigen::Vector2d& pixel, double farthest_rad, Eigen::Vector3d& ray);
/// Pixel of a unit ray; false as above. Unlike CameraModel::project it supports rays near and beyond 90 degrees.
bool pixel_of(const CameraModel& camera, const Eigen::Vector3d& ray, double farthest_rad, Eigen::Vector2d& pixel);

}  // namespace odograph::skyline
