// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::known_object {

/// From the camera's pose to the object: x_c = R_c_o x_o + t_c_o.
struct Pose {
  Eigen::Matrix3d R_c_o = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t_c_o = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x_o) const { return R_c_o * x_o + t_c_o; }
  /// x_c + theta x x_c + delta.
  Pose moved(const Eigen::Matrix<double, 6, 1>& theta_delta) const;
};

/// A rolling-shutter lens on a moving camera.
struct RollingLens {
  CameraModel camera;
  int width = 0, height = 0;
  double line_time_s = 0;
  Eigen::Vector3d rate_c = Eigen::Vector3d::Zero();      ///< rad/s, of the camera, in c
  Eigen::Vector3d velocity_c = Eigen::Vector3d::Zero();  ///< m/s, of the camera, in c

  struct Seen {
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> by_point;  ///< derivative by the point in c at the middle row's time
  };
  /// Projects a point given in c at the middle row's time; nothing behind the camera or more than 75 degrees off its
  /// axis.
  std::optional<Seen> project(const Eigen::Vector3d& p_c) const;
  bool is_inside(const Eigen::Vector2d& pixel, double margin_px) const {
    return pixel.x() >= margin_px && pixel.y() >= margin_px && pixel.x() <= width - 1 - margin_px &&
           pixel.y() <= height - 1 - margin_px;
  }
};

}  // namespace odograph::known_object
