// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/camera/camera_model.hpp"

#include <cmath>

#include <opencv2/calib3d.hpp>

#include "sdk/math/lens.hpp"

namespace odograph {

void CameraModel::undistort(const std::vector<cv::Point2f>& pixels, std::vector<cv::Point2d>& normalized) const {
  normalized.resize(pixels.size());
  if (pixels.empty()) return;
  if (coefficients.empty()) {
    for (size_t i = 0; i < pixels.size(); ++i) normalized[i] = {(pixels[i].x - cx) / fx, (pixels[i].y - cy) / fy};
    return;
  }
  const cv::Matx33d K(fx, 0, cx, 0, fy, cy, 0, 0, 1);
  const std::vector<cv::Point2d> exact(pixels.begin(), pixels.end());
  if (distortion == Distortion::kannala_brandt)
    cv::fisheye::undistortPoints(exact, normalized, K, coefficients);
  else
    cv::undistortPoints(exact, normalized, K, coefficients);
}

Eigen::Vector2d CameraModel::project(const Eigen::Vector2d& p) const {
  const LensCoefficients k{coefficients.data(), coefficients.size()};
  Eigen::Vector2d d = p;
  if (distortion == Distortion::kannala_brandt) {
    if (const double r = p.norm(); r > 1e-12) d *= kannala_brandt(std::atan(r), k) / r;
  } else {
    d = radial_tangential(p, k);
  }
  return {fx * d.x() + cx, fy * d.y() + cy};
}

}  // namespace odograph
