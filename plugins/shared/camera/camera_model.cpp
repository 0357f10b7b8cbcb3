// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/camera/camera_model.hpp"

#include <cmath>

#include <opencv2/calib3d.hpp>

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
  const auto k = [&](size_t i) { return i < coefficients.size() ? coefficients[i] : 0.0; };
  const double r2 = p.squaredNorm();
  Eigen::Vector2d d = p;
  if (distortion == Distortion::kannala_brandt) {
    const double r = std::sqrt(r2), theta = std::atan(r), t2 = theta * theta;
    const double bent = theta * (1 + t2 * (k(0) + t2 * (k(1) + t2 * (k(2) + t2 * k(3)))));
    if (r > 1e-12) d *= bent / r;
  } else {
    const double radial = (1 + r2 * (k(0) + r2 * (k(1) + r2 * k(4)))) / (1 + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
    const double xy = 2 * p.x() * p.y();
    d = radial * p +
        Eigen::Vector2d(k(2) * xy + k(3) * (r2 + 2 * p.x() * p.x()), k(2) * (r2 + 2 * p.y() * p.y()) + k(3) * xy);
  }
  return {fx * d.x() + cx, fy * d.y() + cy};
}

}  // namespace odograph
