// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/gyro_attitude.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

void GyroAttitude::reset(const Quaterniond& q_n_c, const Matrix3d& covariance_n) {
  bias_c_.setZero();
  P_.setZero();
  P_.bottomRightCorner<3, 3>() = Matrix3d::Identity() * p_.bias_sigma_radps * p_.bias_sigma_radps;
  realign(q_n_c, covariance_n);
}

void GyroAttitude::realign(const Quaterniond& q_n_c, const Matrix3d& covariance_n) {
  q_n_c_ = q_n_c;
  P_.topRows<3>().setZero();
  P_.leftCols<3>().setZero();
  P_.topLeftCorner<3, 3>() = covariance_n;
}

void GyroAttitude::propagate(const Quaterniond& q_c0_c1, double dt_s) {
  Matrix6d F = Matrix6d::Identity();
  F.topRightCorner<3, 3>() = -dt_s * q_n_c_.toRotationMatrix();
  q_n_c_ = (q_n_c_ * q_c0_c1 * exp_rotation(-bias_c_ * dt_s)).normalized();
  P_ = F * P_ * F.transpose();
  P_.diagonal().head<3>().array() += p_.angle_random_walk * p_.angle_random_walk * dt_s;
  P_.diagonal().tail<3>().array() += p_.bias_walk * p_.bias_walk * dt_s;
}

void GyroAttitude::update_relative_rotation(const Quaterniond& gyro, const Quaterniond& seen, double sigma_rad,
                                            double dt_s) {
  if (dt_s <= 0) return;
  const Vector3d bias_error = log_rotation(seen.conjugate() * gyro) / dt_s - bias_c_;
  const double sigma = std::max(sigma_rad, p_.min_camera_sigma_rad) / dt_s;
  const Matrix3d S = P_.bottomRightCorner<3, 3>() + Matrix3d::Identity() * (sigma * sigma);
  const Eigen::Matrix<double, 6, 3> K = P_.rightCols<3>() * S.inverse();
  P_ -= K * P_.bottomRows<3>().eval();
  apply(K * bias_error);
}

std::optional<Vector3d> GyroAttitude::correct(const Vector3d& off_n, const Matrix3d& covariance_n, double gate_sigma) {
  const Matrix3d S = P_.topLeftCorner<3, 3>() + covariance_n + Matrix3d::Identity() * 1e-12;
  const Matrix3d S_inverse = S.inverse();
  if (gate_sigma > 0 && off_n.dot(S_inverse * off_n) > gate_sigma * gate_sigma) return std::nullopt;
  const Eigen::Matrix<double, 6, 3> K = P_.leftCols<3>() * S_inverse;
  P_ -= K * P_.topRows<3>().eval();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  return apply(K * off_n);
}

void GyroAttitude::update_gravity(const Vector3d& force_c, bool standing) {
  const double norm = force_c.norm();
  if (std::abs(norm - 9.81) > 2) return;
  const Vector3d off = (q_n_c_ * force_c / norm).cross(-Vector3d::UnitZ());
  const double sigma = standing ? p_.standing_sigma_rad : p_.moving_sigma_rad;
  correct(off, Vector3d(sigma * sigma, sigma * sigma, 1e6).asDiagonal(), 0);
}

Vector3d GyroAttitude::apply(const Vector6d& error) {
  q_n_c_ = (exp_rotation(error.head<3>()) * q_n_c_).normalized();
  bias_c_ += error.tail<3>();
  return error.head<3>();
}

}  // namespace odograph
