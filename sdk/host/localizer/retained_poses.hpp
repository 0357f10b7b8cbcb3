// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// A retained past pose of the body, with its current estimate.
struct RetainedPose {
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
  /// Covariance of (rotation in n, position), rad and m, squared: of the retained pose, of the current pose, and of the
  /// retained pose with the current one.
  Eigen::Matrix<double, 6, 6> own = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> now = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> cross = Eigen::Matrix<double, 6, 6>::Zero();
};

/// The poses that anchors refer to. Not thread-safe.
class RetainedPoses {
 public:
  virtual ~RetainedPoses() = default;

  /// Retains the body's pose at t, or the oldest stored one. Later measurements correct it according to its correlation
  /// with the current state. Returns an id from 1, never reused; 0 if t has not been reached yet. release_pose()
  /// releases it.
  virtual uint64_t retain_pose(int64_t t_ns) = 0;
  virtual void release_pose(uint64_t id) = 0;
  /// Its current estimate; false if it is not retained (for example after a reset).
  virtual bool retained_pose(uint64_t id, RetainedPose& out) const = 0;
  /// The body's current pose with its covariance, in the form of retained_pose(); `own` and `cross` equal `now`.
  virtual bool pose_now(RetainedPose& out) const = 0;
  /// Horizontal position in n is known, from the configured start or from a fix.
  virtual bool is_placed() const = 0;
};

}  // namespace odograph
