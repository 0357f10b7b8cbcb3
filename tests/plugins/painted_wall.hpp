// SPDX-License-Identifier: Apache-2.0
//
// Pictures of a painted wall, whose geometry is exact, for the recognition of places.
#pragma once

#include <random>

#include <opencv2/imgproc.hpp>

#include "plugins/fix/map/place_map.hpp"
#include "tests/support/support.hpp"

namespace odograph::place_map {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = M_PI / 180;

/// The corner of a room 3 m ahead, painted with shapes that cover each other: two walls whose depth falls by `slope`
/// to either side; without a slope, one flat wall. World: x right, y down.
class Wall {
 public:
  static constexpr double kAhead_m = 3, kPerMetre = 200;

  explicit Wall(unsigned seed, double slope = 0.4) : paint_(800, 1200, CV_8U, cv::Scalar(128)), slope_(slope) {
    std::mt19937 draws(seed);
    const auto below = [&](int n) { return static_cast<int>(draws() % static_cast<unsigned>(n)); };
    for (int i = 0; i < 900; ++i) {
      cv::Point at;
      at.x = below(paint_.cols), at.y = below(paint_.rows);
      const int size = 5 + below(60), grey = below(256);
      if (below(2) == 0)
        cv::circle(paint_, at, size / 2, grey, cv::FILLED);
      else
        cv::rectangle(paint_, at, at + cv::Point(size, 5 + below(60)), grey, cv::FILLED);
    }
  }

  /// The world point on a ray.
  Vector3d hit(const Vector3d& from, const Vector3d& ray) const {
    double nearest = 1e9;
    for (const double side : {-slope_, slope_}) {
      const double towards = ray.z() + side * ray.x();
      if (towards > 0) nearest = std::min(nearest, (kAhead_m - from.z() - side * from.x()) / towards);
    }
    return from + nearest * ray;
  }

  Picture picture(const Rigid& T_w_c, double focal_px = 500, cv::Size size = {640, 480}, double light = 1) const {
    Picture out;
    out.lens.fx = out.lens.fy = focal_px;
    out.lens.cx = 0.5 * (size.width - 1), out.lens.cy = 0.5 * (size.height - 1);
    cv::Mat columns(size, CV_32F), rows(size, CV_32F);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Vector3d ray = T_w_c.q * Vector3d((x - out.lens.cx) / focal_px, (y - out.lens.cy) / focal_px, 1);
        const Vector3d p = hit(T_w_c.p, ray);
        columns.at<float>(y, x) = static_cast<float>(p.x() * kPerMetre + 0.5 * paint_.cols);
        rows.at<float>(y, x) = static_cast<float>(p.y() * kPerMetre + 0.5 * paint_.rows);
      }
    cv::remap(paint_, out.grey, columns, rows, cv::INTER_LINEAR, cv::BORDER_CONSTANT, 128);
    cv::GaussianBlur(out.grey, out.grey, {0, 0}, 0.8);
    out.grey.convertTo(out.grey, CV_8U, light);
    out.down_c = T_w_c.q.conjugate() * Vector3d::UnitY();
    out.tilt_sigma_rad = 0.005;
    return out;
  }

  /// Landmarks at corners of the picture, as a front-end would have them.
  std::vector<Landmark> landmarks(const Picture& picture, const Rigid& T_w_c) const {
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(picture.grey, corners, 150, 0.01, 12);
    std::vector<Landmark> out;
    for (const cv::Point2f& corner : corners) {
      Landmark& landmark = out.emplace_back();
      landmark.id = out.size(), landmark.pixel = Eigen::Vector2d(corner.x, corner.y);
      landmark.p_c = T_w_c.inverse() * hit(T_w_c.p, T_w_c.q * rays_of(picture.lens, {corner}, 1.4)[0]);
      landmark.covariance = 1e-4 * Eigen::Matrix3d::Identity();
    }
    return out;
  }

 private:
  cv::Mat paint_;
  double slope_;
};

inline Rigid at(const Vector3d& p, double yaw_deg = 0, double roll_deg = 0) {
  return {Quaterniond(Eigen::AngleAxisd(yaw_deg * kDegree, Vector3d::UnitY()) *
                      Eigen::AngleAxisd(roll_deg * kDegree, Vector3d::UnitZ())),
          p};
}

inline uint64_t add(PlaceMap& map, const Wall& wall, const Rigid& T_w_c, const Rigid& T_m_w = {}, uint32_t epoch = 0) {
  const Picture picture = wall.picture(T_w_c);
  return map.add(picture, wall.landmarks(picture, T_w_c), T_m_w * T_w_c, epoch);
}

}  // namespace odograph::place_map
