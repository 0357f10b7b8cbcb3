// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <odograph/types.h>

#include "sdk/tools/recording/trajectory.hpp"

namespace odograph {

/// A camera pose from the composed motions of a visual odometry.
struct ComposedPose {
  int64_t t_ns = 0;
  /// From c to the composed frame, which has the first camera's axes.
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d unscaled = Eigen::Vector3d::Zero();  ///< position up to scale, with every displacement
  /// Position in m: displacements of a scale group count from its first metric motion on, others are ignored.
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
  uint32_t scale_group = 0;
  bool placed = false;     ///< the motion that ends here had a displacement, and the odometry was not lost
  bool metric = false;     ///< placed, and its group has had a metric motion
  bool tracking = false;   ///< the motion that ends here states that it is tracking
  double scale_sigma = 0;  ///< relative, last stated in the group; 0: none
  std::optional<Eigen::Vector3d> gravity;  ///< down, in the composed frame, if the motion states it
};

struct ComposedMotions {
  std::vector<ComposedPose> poses;  ///< the start of the first motion, then the end of each
  size_t holes = 0;                 ///< motions that do not start where the previous one ended

  StampedPoses unscaled() const;  ///< every pose, up to scale
  StampedPoses metric() const;    ///< the metric poses
};

/// Composes the motions, rotation and displacement, without host or other sensors. A motion without a valid rotation or
/// displacement leaves orientation or position unchanged.
ComposedMotions compose(const std::vector<odo_vo_motion>& motions);

}  // namespace odograph
