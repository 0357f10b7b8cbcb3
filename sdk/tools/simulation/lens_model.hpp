// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Camera directions with z = 1 of pixels, with OpenCV's lens models.
std::vector<cv::Point2d> rays_of(const odo_calibration& lens, const std::vector<cv::Point2d>& pixels);

/// Pixel of a point in camera coordinates, m.
cv::Point2d project(const odo_calibration& lens, const Eigen::Vector3d& p_c);

}  // namespace odograph
