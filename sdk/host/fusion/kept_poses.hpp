// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

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

/// Something fixed to a kept pose: its pose in the axes of that, and the covariance of (heading, position) between
/// both, rad and m, squared, in these axes.
struct Attachment {
  uint64_t pose_id = 0;  ///< 0: to none
  Rigid T_kept_x;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
};

/// A kept pose is given up, and another one takes over what is fixed to it.
struct HandOver {
  uint64_t from = 0, to = 0;
  Rigid T_n_from, T_n_to;
  /// Covariance of (heading, position) in n: of each, and of the first with the second.
  Eigen::Matrix4d of_from, of_to, common;

  void apply(Attachment& attachment) const;
};

/// The poses of the past that anchors and key frames refer to, at most 64. Not thread-safe.
class KeptPoses {
 public:
  virtual ~KeptPoses() = default;

  /// The body's pose at t, or the oldest stored one, fixed to a kept pose: one so near that the track between them adds
  /// less than a stated error, otherwise a new one; the one with the least error between it and a neighbour makes room.
  /// Later measurements correct it according to its correlation with the current state. None if t has not been reached.
  virtual Attachment keep_pose(int64_t t_ns) = 0;
  virtual void release_pose(uint64_t id) = 0;
  /// What was handed over since the last call, in this order.
  virtual std::vector<HandOver> take_hand_overs() = 0;
  /// Its current estimate; false if it is not kept (for example after a reset).
  virtual bool kept_pose(uint64_t id, KeptPose& out) const = 0;
  /// The kept frame of a plugin's map, once it was recognised; 0: not yet.
  virtual uint64_t map_frame(uint32_t source, uint64_t map) const = 0;
  /// The body's current pose with its covariance, in the form of kept_pose(); `own` and `cross` equal `now`.
  virtual bool pose_now(KeptPose& out) const = 0;
  /// Horizontal position in n is known, from the configured start or from a fix.
  virtual bool is_placed() const = 0;
};

/// Fixes something, given in the axes of the body, to the pose that the body is fixed to. `q_n_kept`: its orientation.
Attachment attach(const Attachment& body, const Rigid& T_b_x, const Eigen::Quaterniond& q_n_kept);

}  // namespace odograph
