// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <odograph/types.h>

#include "sdk/tools/recording/trajectory.hpp"

namespace odograph {

/// Where a visual odometry's motions have led the camera.
struct ComposedPose {
  int64_t t_ns = 0;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  ///< from c to the chain's frame, the first camera's axes
  Eigen::Vector3d own = Eigen::Vector3d::Zero();          ///< position up to scale, every displacement counted
  /// Position in m: displacements of a scale group count from its first metric motion on, others leave it as it is.
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
  uint32_t scale_group = 0;
  bool placed = false;     ///< the motion that ends here had a displacement, and the odometry was not lost
  bool metric = false;     ///< placed, and its group has had a metric motion
  bool tracking = false;   ///< the motion that ends here says that it follows the world
  double scale_sigma = 0;  ///< relative, of the newest motion of the group that said it; 0: none did
  std::optional<Eigen::Vector3d> gravity;  ///< downwards in the chain's frame, where the motion gave it
};

struct ComposedMotions {
  std::vector<ComposedPose> poses;  ///< the first motion's beginning, then each motion's end
  size_t holes = 0;                 ///< motions that do not begin where the last one ended

  Trajectory own() const;     ///< every pose, up to scale
  Trajectory metric() const;  ///< the metric poses
};

/// The motions one after the other, rotation and displacement, and nothing else: no host, no other sensor. A motion
/// without a valid rotation or displacement leaves orientation or position as it is.
ComposedMotions compose(const std::vector<odo_vo_motion>& motions);

}  // namespace odograph
