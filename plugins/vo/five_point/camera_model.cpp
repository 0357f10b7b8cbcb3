// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/five_point/camera_model.hpp"

#include <opencv2/calib3d.hpp>

namespace odograph::five_point {

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

}  // namespace odograph::five_point
