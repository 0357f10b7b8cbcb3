// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// A pose of the body in the past that is kept because something hangs on it, as it is known now.
struct HeldPose {
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n_b = Eigen::Vector3d::Zero();  ///< m
  /// Of the small rotation in n and the position, rad and m, squared: of the held pose, of the body now, and held by
  /// now.
  Eigen::Matrix<double, 6, 6> own = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> now = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> cross = Eigen::Matrix<double, 6, 6>::Zero();
};

/// What anchors hang on. One thread at a time.
class HeldPoses {
 public:
  virtual ~HeldPoses() = default;

  /// Holds the body's pose at t, or the oldest that is kept: what is learnt later moves it as it should, by as much of
  /// a correction as is its own. A number from 1, never given twice; 0 where that time has not come yet. let_go ends
  /// it.
  virtual uint64_t hold_pose(int64_t t_ns) = 0;
  virtual void let_go(uint64_t id) = 0;
  /// As it is known now; false where it is not held (any more: reset).
  virtual bool held_pose(uint64_t id, HeldPose& out) const = 0;
  /// The body's pose now with its covariance, as held_pose has it; `own` and `cross` are the same as `now`.
  virtual bool pose_now(HeldPose& out) const = 0;
  /// Horizontal position against n is known, by the start that was given or by a fix.
  virtual bool is_placed() const = 0;
};

}  // namespace odograph
