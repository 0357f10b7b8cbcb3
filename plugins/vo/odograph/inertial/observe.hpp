// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "plugins/vo/odograph/inertial/parameters.hpp"
#include "plugins/vo/odograph/inertial/state.hpp"

namespace odograph::vio {

/// A corner as a clone's frame has it.
struct Observation {
  uint32_t clone = 0;                               ///< id
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< as the calibrated lens would have it
  double row = 0;                                   ///< of the frame
};

/// Where a clone's frame has a point, with the rolling shutter: the row's time decides the pose.
struct Observed {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;           ///< px by metres in w
  Eigen::Vector2d by_line_time;                   ///< px by s
  Eigen::Matrix<double, 2, kLensStates> by_lens;  ///< the focal length is the clone's
  Eigen::Matrix<double, 2, block::clone> by_clone;
  Eigen::Vector2d by_follow;  ///< by what part of the rotation the lens takes out
  double depth_m = 0;
};

/// Nothing where the point is behind the camera. `row`: of the corner, px.
std::optional<Observed> observe(const Clone& clone, const Camera& camera, const Eigen::Vector3d& p_w, double row);

/// The ray of a pixel in the clone's camera at the middle row, z = 1: without distortion and the rotation between the
/// rows.
Eigen::Vector3d ray_of(const Clone& clone, const Camera& camera, const Eigen::Vector2d& pixel, double row);

/// A point from a track with its first clone as anchor.
struct Triangulated {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< x/z, y/z, 1/z in the anchor
  double parallax_rad = 0;                       ///< largest angle between two rays
  double rms_px = 0;
};

/// By Gauss-Newton over the reprojection errors with the poses as they are, from the two rays farthest apart. Nothing
/// where it does not converge in front of the cameras.
std::optional<Triangulated> triangulate(const State& state, const std::vector<Observation>& track,
                                        const FilterParameters& p);

}  // namespace odograph::vio
