// SPDX-License-Identifier: Apache-2.0
//
// Rotations as docs/notation.md has them: what every plugin uses, once.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph::so3 {

/// Exp: a rotation vector, rad, to a rotation (Sola 2017, eq. (101)). The identity of zero; no threshold else.
inline Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle)) : Eigen::Quaterniond::Identity();
}

/// The same as a matrix (Rodrigues), which is cheaper where no quaternion is wanted.
inline Eigen::Matrix3d exp_rotation_matrix(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  return angle < 1e-15 ? Eigen::Matrix3d::Identity().eval() : Eigen::AngleAxisd(angle, v / angle).toRotationMatrix();
}

/// Log: the shortest rotation vector, rad (Sola 2017, eq. (103)), of q as of -q. Below 1e-12 to first order.
inline Eigen::Vector3d log_rotation(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine < 1e-12) return q.w() < 0 ? Eigen::Vector3d(-2 * q.vec()) : Eigen::Vector3d(2 * q.vec());
  return 2 * std::atan2(q.w() < 0 ? -sine : sine, std::abs(q.w())) / sine * q.vec();
}

/// [v]x: skew(a) * b is a x b.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// A rigid transform from rotation and position; the quaternion is normalised.
inline Eigen::Isometry3d isometry(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() = p;
  return T;
}

/// Of a message, where w stands first; as it is, not normalised.
inline Eigen::Quaterniond quaternion(const double* wxyz) { return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]}; }
inline void put_quaternion(const Eigen::Quaterniond& q, double* wxyz) {
  wxyz[0] = q.w(), wxyz[1] = q.x(), wxyz[2] = q.y(), wxyz[3] = q.z();
}

}  // namespace odograph::so3
