// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Directions with z = 1 in the camera's frame of pixels, by OpenCV's models of the lens.
std::vector<cv::Point2d> rays_of(const odo_calibration& lens, const std::vector<cv::Point2d>& pixels);

/// Pixel of a point before the camera, m in its frame.
cv::Point2d project(const odo_calibration& lens, const Eigen::Vector3d& p_c);

}  // namespace odograph
