// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/base/rigid.hpp"

namespace odograph {

/// A kept pose of the body with its current estimate.
struct KeptPose {
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
  /// Covariance of (rotation in n, position), rad and m, squared: of the kept pose, of the current pose, and of the
  /// kept pose with the current one.
  Eigen::Matrix<double, 6, 6> own = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> now = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> cross = Eigen::Matrix<double, 6, 6>::Zero();
};

/// The poses of the past that anchors refer to, at most 64. Not thread-safe.
class KeptPoses {
 public:
  /// A pose of the body relative to a kept one near it.
  struct Near {
    uint64_t id = 0;                                       ///< of the kept pose, from 1, never reused; 0: none
    Rigid T_kept_b;                                        ///< the body there in the axes of the kept pose
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of (heading, position) between both, in n
    bool full = false;                                     ///< no further pose can be kept
  };
  /// Two kept poses, one of which can take over what refers to the other.
  struct Neighbours {
    uint64_t given_up, stays;
  };
  virtual ~KeptPoses() = default;

  /// The body's pose at t, or the oldest stored one, relative to a kept pose: one so near that the track between them
  /// adds less than a stated error, otherwise a new one. Later measurements correct it according to its correlation
  /// with the current state. None if t has not been reached yet, or if there is no room.
  virtual Near keep_pose(int64_t t_ns) = 0;
  /// If there is no room for another kept pose: the two that are nearest to each other.
  virtual std::optional<Neighbours> crowded() const = 0;
  virtual void release_pose(uint64_t id) = 0;
  /// Its current estimate; false if it is not kept (for example after a reset).
  virtual bool kept_pose(uint64_t id, KeptPose& out) const = 0;
  /// Covariance of (heading, position) of one kept pose with that of another.
  virtual Eigen::Matrix4d covariance_of(uint64_t one, uint64_t other) const = 0;
  /// The body's current pose with its covariance, in the form of kept_pose(); `own` and `cross` equal `now`.
  virtual bool pose_now(KeptPose& out) const = 0;
  /// Horizontal position in n is known, from the configured start or from a fix.
  virtual bool is_placed() const = 0;
};

}  // namespace odograph
