// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/math/rotation.hpp"

namespace odograph {

/// Converts the pose of one rigid part (old, o) to the pose of another (new, w) mounted on it: q_o_w rotates vectors
/// from w to o, p_o_w is the origin of w in o, m. With the lever arm l = R_n_o p_o_w, position, velocity (v + omega x
/// l, if the rates are known) and covariances are transformed to first order: a left rotation error theta moves the new
/// origin by theta x l.
inline void move_pose(const Eigen::Quaterniond& q_o_w, const Eigen::Vector3d& p_o_w, odo_pose& pose) {
  using Eigen::Matrix3d, Eigen::Quaterniond, Eigen::Vector3d;
  using Matrix6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  const Quaterniond q_n_o = raw_quaternion(pose.q_n);
  const Quaterniond q_n_w = q_n_o * q_o_w;
  const Vector3d lever = q_n_o * p_o_w;
  if (pose.header.flags & ODO_POSE_ANGULAR_VELOCITY) {
    const Vector3d rate_o(pose.angular_velocity);
    if (pose.header.flags & ODO_POSE_VELOCITY) Vector3d::Map(pose.velocity_n) += (q_n_o * rate_o).cross(lever);
    Vector3d::Map(pose.angular_velocity) = q_o_w.conjugate() * rate_o;
  }
  Vector3d::Map(pose.p_n) += lever;
  put_quaternion(q_n_w, pose.q_n);
  Matrix6d jacobian = Matrix6d::Identity();
  jacobian.bottomLeftCorner<3, 3>() = -skew(lever);
  Eigen::Map<Matrix6d> covariance(pose.covariance);
  covariance = (jacobian * covariance * jacobian.transpose()).eval();
}

/// Converts a pose to another n: a point x in the old n is at q * x + p in the new one.
inline void move_frame(const Eigen::Quaterniond& q, const Eigen::Vector3d& p, odo_pose& pose) {
  using Eigen::Matrix3d, Eigen::Vector3d;
  using Matrix6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  using Matrix3dRows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Matrix3d R = q.toRotationMatrix();
  put_quaternion((q * raw_quaternion(pose.q_n)).normalized(), pose.q_n);
  Vector3d::Map(pose.p_n) = (q * Vector3d(pose.p_n) + p).eval();
  Vector3d::Map(pose.velocity_n) = (R * Vector3d(pose.velocity_n)).eval();
  Matrix6d both = Matrix6d::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = R;
  Eigen::Map<Matrix6d> covariance(pose.covariance);
  covariance = (both * covariance * both.transpose()).eval();
  Eigen::Map<Matrix3dRows> velocity_covariance(pose.velocity_covariance);
  velocity_covariance = (R * velocity_covariance * R.transpose()).eval();
}

}  // namespace odograph
