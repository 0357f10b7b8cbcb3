// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/lens_model.hpp"

#include <opencv2/calib3d.hpp>

namespace odograph {
namespace {

cv::Matx33d matrix_of(const odo_calibration& lens) { return {lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1}; }

std::vector<double> distortion_of(const odo_calibration& lens) {
  return {lens.distortion, lens.distortion + lens.distortion_count};
}

}  // namespace

std::vector<cv::Point2d> rays_of(const odo_calibration& lens, const std::vector<cv::Point2d>& pixels) {
  std::vector<cv::Point2d> rays;
  if (lens.model == ODO_CAMERA_KANNALA_BRANDT)
    cv::fisheye::undistortPoints(pixels, rays, matrix_of(lens), distortion_of(lens));
  else
    cv::undistortPoints(pixels, rays, matrix_of(lens), distortion_of(lens), cv::noArray(), cv::noArray(),
                        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-10));
  return rays;
}

cv::Point2d project(const odo_calibration& lens, const Eigen::Vector3d& p_c) {
  const std::vector<cv::Point3d> point = {{p_c.x(), p_c.y(), p_c.z()}};
  std::vector<cv::Point2d> pixel;
  const cv::Vec3d zero(0, 0, 0);
  if (lens.model == ODO_CAMERA_KANNALA_BRANDT)
    cv::fisheye::projectPoints(point, pixel, zero, zero, matrix_of(lens), distortion_of(lens));
  else
    cv::projectPoints(point, zero, zero, matrix_of(lens), distortion_of(lens), pixel);
  return pixel[0];
}

}  // namespace odograph
