// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace odograph {

/// Intrinsics of a camera.
struct CameraModel {
  enum class Distortion { radial_tangential, kannala_brandt };
  Distortion distortion = Distortion::radial_tangential;
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  std::vector<double> coefficients;       ///< OpenCV's order; empty = none

  /// Pixels to normalized image coordinates (x/z, y/z) of an ideal pinhole. `normalized` is resized.
  void undistort(const std::vector<cv::Point2f>& pixels, std::vector<cv::Point2d>& normalized) const;
  /// Normalized image coordinates to pixels: the exact model, also outside the range in which its polynomial is valid.
  Eigen::Vector2d project(const Eigen::Vector2d& normalized) const;
  double focal() const { return 0.5 * (fx + fy); }
  bool operator==(const CameraModel&) const = default;
};

}  // namespace odograph
