// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/sky_rays.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace odograph::skyline {
namespace {

double bent(const CameraModel& camera, double theta) {
  const auto k = [&](size_t i) { return i < camera.coefficients.size() ? camera.coefficients[i] : 0.0; };
  const double t2 = theta * theta;
  return theta * (1 + t2 * (k(0) + t2 * (k(1) + t2 * (k(2) + t2 * k(3)))));
}

}  // namespace

bool pixel_of(const CameraModel& camera, const Eigen::Vector3d& ray, double farthest_rad, Eigen::Vector2d& pixel) {
  const double across = ray.head<2>().norm(), theta = std::atan2(across, ray.z());
  if (theta > farthest_rad) return false;
  if (camera.distortion == CameraModel::Distortion::kannala_brandt) {
    const Eigen::Vector2d d =
        across > 1e-12 ? Eigen::Vector2d(ray.head<2>() * (bent(camera, theta) / across)) : Eigen::Vector2d::Zero();
    pixel = {camera.fx * d.x() + camera.cx, camera.fy * d.y() + camera.cy};
    return true;
  }
  if (ray.z() < 0.05) return false;
  pixel = camera.project(ray.head<2>() / ray.z());
  return true;
}

bool ray_of(const CameraModel& camera, const Eigen::Vector2d& pixel, double farthest_rad, Eigen::Vector3d& ray) {
  if (camera.distortion == CameraModel::Distortion::kannala_brandt) {
    const Eigen::Vector2d d((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
    const double r = d.norm();
    double theta = std::min(r, farthest_rad);
    for (int i = 0; i < 12; ++i) {
      constexpr double h = 1e-4;
      const double slope = (bent(camera, theta + h) - bent(camera, theta - h)) / (2 * h);
      if (slope < 0.05) return false;  // the polynomial is not monotonic
      theta -= (bent(camera, theta) - r) / slope;
      if (!(theta >= 0 && theta < 2.5)) return false;
    }
    if (theta > farthest_rad || std::abs(bent(camera, theta) - r) > 1e-6) return false;
    ray << (r > 1e-12 ? Eigen::Vector2d(d * (std::sin(theta) / r)) : Eigen::Vector2d::Zero()), std::cos(theta);
    return true;
  }
  std::vector<cv::Point2d> normalized;
  camera.undistort({{static_cast<float>(pixel.x()), static_cast<float>(pixel.y())}}, normalized);
  ray = Eigen::Vector3d(normalized[0].x, normalized[0].y, 1).normalized();
  return std::acos(ray.z()) <= farthest_rad;
}

}  // namespace odograph::skyline
