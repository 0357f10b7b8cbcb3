// SPDX-License-Identifier: Apache-2.0
//
// Rotations in the notation of docs/notation.md. Perturbations are on the left.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// Exp: rotation vector, rad, to rotation (Sola 2017, eq. (101)). The identity only for exactly zero; no small-angle
/// threshold.
inline Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle)) : Eigen::Quaterniond::Identity();
}

/// Exp as a matrix (Rodrigues); cheaper where no quaternion is needed.
inline Eigen::Matrix3d exp_rotation_matrix(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  return angle < 1e-15 ? Eigen::Matrix3d::Identity().eval() : Eigen::AngleAxisd(angle, v / angle).toRotationMatrix();
}

/// Log: the shortest rotation vector, rad (Sola 2017, eq. (103)); the same for q and -q. First order below 1e-12.
inline Eigen::Vector3d log_rotation(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine < 1e-12) return q.w() < 0 ? Eigen::Vector3d(-2 * q.vec()) : Eigen::Vector3d(2 * q.vec());
  return 2 * std::atan2(q.w() < 0 ? -sine : sine, std::abs(q.w())) / sine * q.vec();
}

/// Shortest rotation from the direction of one vector to that of another; between opposite ones, about an axis across
/// them. Equal to Eigen's FromTwoVectors, which finds that axis by a singular value decomposition: seconds to compile.
inline Eigen::Quaterniond shortest_rotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  Eigen::Quaterniond q;
  if (cosine < -1 + 1e-12) {
    const Eigen::Vector3d other = std::abs(a.y()) < 0.9 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    const double w_squared = std::max(0.0, 0.5 * (1 + cosine));
    q.w() = std::sqrt(w_squared);
    q.vec() = std::sqrt(1 - w_squared) * a.cross(other).normalized();
    return q;
  }
  const double twice_w = std::sqrt(2 * (1 + cosine));
  q.vec() = a.cross(b) * (1 / twice_w);
  q.w() = 0.5 * twice_w;
  return q;
}

/// Skew-symmetric matrix [v]x: skew(a) * b = a x b.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Left Jacobian of a rotation vector, rad: Exp(v) = 1 + J [v]x (Sola 2017, eq. (183)). A point at r from the pivot
/// moves by J (v x r), to first order v x r.
inline Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const Eigen::Matrix3d x = skew(v);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * x;
  const double squared = angle * angle;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / squared * x +
         (angle - std::sin(angle)) / (squared * angle) * x * x;
}

/// Rigid transform from a rotation, which is normalised, and a position.
inline Eigen::Isometry3d isometry(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() = p;
  return T;
}

/// Quaternion from four numbers w, x, y, z, as in messages. Not normalised: those that the host wrote or checked have
/// unit norm.
inline Eigen::Quaterniond raw_quaternion(const double* wxyz) { return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]}; }
/// The same, normalised.
inline Eigen::Quaterniond quaternion(const double* wxyz) { return raw_quaternion(wxyz).normalized(); }
inline void put_quaternion(const Eigen::Quaterniond& q, double* wxyz) {
  wxyz[0] = q.w(), wxyz[1] = q.x(), wxyz[2] = q.y(), wxyz[3] = q.z();
}

/// q_b_c of a phone's rear camera. x points to the right of the screen in both frames; y points down the picture in c
/// and up in b, z points away from the viewer in c and towards the viewer in b. It is its own inverse.
inline Eigen::Quaterniond rear_camera_mount() { return {0, 1, 0, 0}; }

}  // namespace odograph
