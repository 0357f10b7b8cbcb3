// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/sky_rays.hpp"
#include "sdk/tools/simulation/city_model.hpp"
#include "tests/support/support.hpp"

/// A street of boxes as a city model, and pictures of it.
namespace odograph::skyline::test {

/// Of the camera: 640 x 480 pixels.
inline const CameraModel kLens{
    .distortion = CameraModel::Distortion::kannala_brandt, .fx = 200, .fy = 200, .cx = 319.5, .cy = 239.5};

struct Box {
  double north, east, a, b, height;
};
inline constexpr Box kStreet[] = {{0, -25, 30, 20, 50}, {34, -27, 28, 22, 38}, {-33, -26, 30, 20, 61},
                                  {8, 24, 40, 18, 44},  {47, 26, 25, 20, 57},  {-30, 25, 26, 20, 35}};

/// `roofs`: errors of the model's heights, m.
inline void write_street(const std::filesystem::path& file, const std::vector<double>& roofs = {}) {
  std::vector<Building> buildings;
  for (const Box& box : kStreet) {
    const double error = roofs.empty() ? 0 : roofs[buildings.size()];
    const double n = 0.5 * box.a, e = 0.5 * box.b;
    buildings.push_back(
        {{Eigen::Vector3d(box.north - n, box.east - e, 0), Eigen::Vector3d(box.north + n, box.east - e, 0),
          Eigen::Vector3d(box.north + n, box.east + e, 0), Eigen::Vector3d(box.north - n, box.east + e, 0)},
         box.height + error,
         true});
  }
  REQUIRE(write_city_json(file, buildings, {}));
}

/// Whether a ray from a place hits a house.
inline bool meets(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) {
  for (const Box& box : kStreet) {
    const Eigen::Vector3d low(box.north - 0.5 * box.a, box.east - 0.5 * box.b, -box.height);
    const Eigen::Vector3d high(box.north + 0.5 * box.a, box.east + 0.5 * box.b, 0);
    double from = 0, to = 1e9;
    for (int i = 0; i < 3; ++i) {
      const double a = (low[i] - eye[i]) / ray[i], b = (high[i] - eye[i]) / ray[i];
      from = std::max(from, std::min(a, b)), to = std::min(to, std::max(a, b));
    }
    if (from < to) return true;
  }
  return false;
}

/// The view of an upward camera with north at the right: walls with windows in front of a bright sky.
inline cv::Mat view_upwards(const Eigen::Vector3d& eye, const CameraModel& lens = kLens) {
  cv::Mat picture(static_cast<int>(2 * lens.cy) + 1, static_cast<int>(2 * lens.cx) + 1, CV_8UC1, cv::Scalar(70));
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      Eigen::Vector3d ray_c;
      if (!ray_of(lens, {double(x), double(y)}, 1.5, ray_c)) continue;
      const Eigen::Vector3d ray(ray_c.x(), -ray_c.y(), -ray_c.z());
      const double azimuth = std::atan2(ray.y(), ray.x()), up = std::asin(-ray.z());
      const bool window = std::fmod(azimuth * 30 + 100, 2) < 1 && std::fmod(up * 30 + 100, 2) < 1;
      picture.at<uint8_t>(y, x) = !meets(eye, ray) ? 205 : window ? 40 : 95;
    }
  cv::GaussianBlur(picture, picture, {3, 3}, 0.6);
  return picture;
}

}  // namespace odograph::skyline::test
