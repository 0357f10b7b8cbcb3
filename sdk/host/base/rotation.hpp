// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// Exp: a rotation vector, rad, to a rotation.
inline Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& angle) {
  const double norm = angle.norm();
  return norm > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(norm, angle / norm)) : Eigen::Quaterniond::Identity();
}

/// Log: the shortest rotation vector, rad.
inline Eigen::Vector3d log_rotation(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd rotation(q.w() < 0 ? Eigen::Quaterniond(-q.coeffs()) : q);
  return rotation.angle() * rotation.axis();
}

/// Of a message, where w stands first; as it is, which is of unit length where the host has written or checked it.
inline Eigen::Quaterniond raw_quaternion(const double* wxyz) { return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]}; }
/// The same, normalised.
inline Eigen::Quaterniond quaternion(const double* wxyz) { return raw_quaternion(wxyz).normalized(); }
inline void put_quaternion(const Eigen::Quaterniond& q, double* wxyz) {
  wxyz[0] = q.w(), wxyz[1] = q.x(), wxyz[2] = q.y(), wxyz[3] = q.z();
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

}  // namespace odograph
