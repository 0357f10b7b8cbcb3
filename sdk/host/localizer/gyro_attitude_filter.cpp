// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/gyro_attitude_filter.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"

namespace odograph::localizer {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

void GyroAttitudeFilter::reset(const Quaterniond& q_o_c, const Matrix3d& covariance_o) {
  q_o_c_ = q_o_c;
  bias_c_.setZero();
  P_.setZero();
  P_.topLeftCorner<3, 3>() = covariance_o;
  P_.bottomRightCorner<3, 3>() = Matrix3d::Identity() * p_.bias_sigma_radps * p_.bias_sigma_radps;
}

void GyroAttitudeFilter::propagate(const Quaterniond& q_c0_c1, double dt_s) {
  Matrix6d F = Matrix6d::Identity();
  F.topRightCorner<3, 3>() = -dt_s * q_o_c_.toRotationMatrix();
  q_o_c_ = (q_o_c_ * q_c0_c1 * exp_rotation(-bias_c_ * dt_s)).normalized();
  P_ = F * P_ * F.transpose();
  P_.diagonal().head<3>().array() += p_.angle_random_walk * p_.angle_random_walk * dt_s;
  P_.diagonal().tail<3>().array() += p_.bias_walk * p_.bias_walk * dt_s;
}

void GyroAttitudeFilter::update_relative_rotation(const Quaterniond& gyro, const Quaterniond& seen, double sigma_rad,
                                                  double dt_s) {
  if (dt_s <= 0) return;
  const Vector3d bias_error = log_rotation(seen.conjugate() * gyro) / dt_s - bias_c_;
  const double sigma = std::max(sigma_rad, p_.min_seen_sigma_rad) / dt_s;
  const Matrix3d S = P_.bottomRightCorner<3, 3>() + Matrix3d::Identity() * (sigma * sigma);
  const Eigen::Matrix<double, 6, 3> K = P_.rightCols<3>() * S.inverse();
  P_ -= K * P_.bottomRows<3>().eval();
  apply(K * bias_error);
}

std::optional<Vector3d> GyroAttitudeFilter::correct(const Vector3d& off_n, const Matrix3d& covariance_o,
                                                    double gate_sigma) {
  const Matrix3d S = P_.topLeftCorner<3, 3>() + covariance_o + Matrix3d::Identity() * 1e-12;
  const Matrix3d S_inverse = S.inverse();
  if (gate_sigma > 0 && off_n.dot(S_inverse * off_n) > gate_sigma * gate_sigma) return std::nullopt;
  const Eigen::Matrix<double, 6, 3> K = P_.leftCols<3>() * S_inverse;
  P_ -= K * P_.topRows<3>().eval();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  return apply(K * off_n);
}

void GyroAttitudeFilter::update_gravity(const Vector3d& force_c, bool standing) {
  const double norm = force_c.norm();
  if (std::abs(norm - 9.81) > 2) return;
  const Vector3d off = (q_o_c_ * force_c / norm).cross(-Vector3d::UnitZ());
  const double sigma = standing ? p_.standing_sigma_rad : p_.moving_sigma_rad;
  correct(off, Vector3d(sigma * sigma, sigma * sigma, 1e6).asDiagonal(), 0);
}

Vector3d GyroAttitudeFilter::apply(const Vector6d& error) {
  q_o_c_ = (exp_rotation(error.head<3>()) * q_o_c_).normalized();
  bias_c_ += error.tail<3>();
  return error.head<3>();
}

}  // namespace odograph::localizer
