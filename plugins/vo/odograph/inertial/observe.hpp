// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "plugins/vo/odograph/inertial/parameters.hpp"
#include "plugins/vo/odograph/inertial/state.hpp"

namespace odograph::vio {

/// A corner observed by a clone.
struct Observation {
  uint32_t clone = 0;                               ///< id
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< of the calibrated lens
  double row = 0;                                   ///< of the frame
};

/// Predicted observation of a point by a clone. With a rolling shutter the row's time determines the pose.
struct Observed {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;           ///< derivative by the point in w, px/m
  Eigen::Vector2d by_line_time;                   ///< derivative by the line time, px/s
  Eigen::Matrix<double, 2, kLensStates> by_lens;  ///< derivative by the lens; the focal length is the clone's
  Eigen::Matrix<double, 2, block::clone> by_clone;
  Eigen::Vector2d by_gain;  ///< derivative by the gain of the stabiliser
  double depth_m = 0;
};

/// Nothing if the point is behind the camera. `row`: of the corner, px.
std::optional<Observed> observe(const Clone& clone, const Camera& camera, const Eigen::Vector3d& p_w, double row);

/// Ray of a pixel in the clone's camera at the middle row, z = 1: undistorted, and rolling-shutter compensated for the
/// rotation between the rows.
Eigen::Vector3d ray_of(const Clone& clone, const Camera& camera, const Eigen::Vector2d& pixel, double row);

/// A point triangulated from a track; its first clone is the anchor.
struct Triangulated {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< x/z, y/z, 1/z in the anchor
  double parallax_rad = 0;                       ///< largest angle between two rays
  double rms_px = 0;
};

/// Gauss-Newton over the reprojection errors with fixed poses, from the two rays of largest parallax. Nothing if it
/// does not converge in front of the cameras.
std::optional<Triangulated> triangulate(const State& state, const std::vector<Observation>& track,
                                        const FilterParameters& p);

}  // namespace odograph::vio
