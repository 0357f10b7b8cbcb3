// SPDX-License-Identifier: Apache-2.0
//
// Rotations as docs/notation.md has them. Perturbations are on the left.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

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

/// [v]x, so that skew(a) * b is a x b.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// The left Jacobian of a rotation vector, rad: Exp(v) = 1 + J [v]x (Sola 2017, eq. (183)). What a rotation moves by v
/// x r to first order, for a place r from the pivot, it moves by J (v x r).
inline Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const Eigen::Matrix3d x = skew(v);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * x;
  const double squared = angle * angle;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / squared * x +
         (angle - std::sin(angle)) / (squared * angle) * x * x;
}

/// A rigid transform from rotation and position; the quaternion is normalised.
inline Eigen::Isometry3d isometry(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() = p;
  return T;
}

/// Of four numbers of which w stands first, as in messages; as it is, which is of unit length where the host has
/// written or checked it.
inline Eigen::Quaterniond raw_quaternion(const double* wxyz) { return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]}; }
/// The same, normalised.
inline Eigen::Quaterniond quaternion(const double* wxyz) { return raw_quaternion(wxyz).normalized(); }
inline void put_quaternion(const Eigen::Quaterniond& q, double* wxyz) {
  wxyz[0] = q.w(), wxyz[1] = q.x(), wxyz[2] = q.y(), wxyz[3] = q.z();
}

/// q_b_c of a phone's rear camera: x runs to the right of the screen for both, the picture's y down and z away from the
/// viewer, the body's y up and z towards the viewer. Its own inverse.
inline Eigen::Quaterniond rear_camera_mount() { return {0, 1, 0, 0}; }

}  // namespace odograph
