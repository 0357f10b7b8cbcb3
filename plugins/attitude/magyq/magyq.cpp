// SPDX-License-Identifier: Apache-2.0
#include "plugins/attitude/magyq/magyq.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph::magyq {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

}  // namespace

void Filter::update(const Vector3d& gyro, const Vector3d& accel, double dt_s) {
  if (!started_) {
    if (accel.norm() < p_.min_start_accel_mps2) return;
    // One sample alone may be old, or part of a swing, and its error would be the heading's too, by the field's dip.
    q_ = (q_ * exp_rotation(gyro * dt_s)).normalized();
    accel_sum_ += q_ * accel, window_s_ += dt_s;
    if (window_s_ < p_.start_s) return;
    started_ = true;
    q_ = shortest_rotation(accel_sum_, Vector3d::UnitZ()) * q_;
    reset_window();
    P_.setZero();
    P_.topLeftCorner<2, 2>().diagonal().setConstant(p_.start_tilt_rad * p_.start_tilt_rad);
    P_.block<3, 3>(3, 3).diagonal().setConstant(p_.bias_sigma_radps * p_.bias_sigma_radps);
    return;
  }
  predict(gyro, dt_s);
  if (gyro.norm() > p_.saturation_gyro_radps || accel.norm() > p_.saturation_accel_mps2) {
    saturated_ = true;
    return;
  }
  if (std::exchange(saturated_, false)) {
    P_.topRows<3>().setZero(), P_.leftCols<3>().setZero();
    P_.topLeftCorner<3, 3>().diagonal().setConstant(p_.saturation_tilt_rad * p_.saturation_tilt_rad);
    settled_ = false;
    q_ = shortest_rotation(q_ * accel, Vector3d::UnitZ()) * q_;
    reset_window();
  }
  window_s_ += dt_s, ++window_count_;
  accel_sum_ += q_ * accel, rate_sum_ += gyro;
  accel_squares_ += accel.squaredNorm(), rate_squares_ += gyro.squaredNorm();
  if (window_s_ >= p_.window_s) align_with_gravity();
}

/// Strapdown integration. The error is expressed in the Earth frame, where the effect of a bias error rotates with the
/// body.
void Filter::predict(const Vector3d& gyro, double dt_s) {
  q_ = (q_ * exp_rotation((gyro - bias_) * dt_s)).normalized();
  const Matrix3d by_bias = -q_.toRotationMatrix() * dt_s;
  const Matrix3d cross = P_.block<3, 3>(0, 3) + by_bias * P_.block<3, 3>(3, 3);
  P_.block<3, 3>(0, 0) += by_bias * P_.block<3, 3>(3, 0) + cross * by_bias.transpose();
  P_.block<3, 3>(0, 3) = cross;
  P_.block<3, 3>(3, 0) = cross.transpose();
  P_.block<3, 5>(0, kFieldOff) += by_bias * P_.block<3, 5>(3, kFieldOff);
  P_.block<5, 3>(kFieldOff, 0) = P_.block<3, 5>(0, kFieldOff).transpose();
  P_.block<3, 3>(0, 0).diagonal().array() += p_.gyro_noise * p_.gyro_noise * dt_s;
  P_.block<3, 3>(3, 3).diagonal().array() += p_.gyro_walk * p_.gyro_walk * dt_s;
}

/// The mean acceleration in the Earth frame is vertical, apart from the change of velocity within the window. The first
/// window is not gated, since the initial inclination may be part of a swing.
void Filter::align_with_gravity() {
  const auto n = static_cast<double>(window_count_);
  const Vector3d mean = accel_sum_ / n, rate = rate_sum_ / n;
  const double accel_spread = std::sqrt(std::max(0.0, accel_squares_ / n - std::pow(mean.norm(), 2)));
  const double rate_spread = std::sqrt(std::max(0.0, rate_squares_ / n - rate.squaredNorm()));
  calm_ = accel_spread < p_.calm_accel_mps2;
  at_rest_ = accel_spread < p_.rest_accel_mps2 && rate_spread < p_.rest_gyro_radps;
  // Effect of a rotation error, true over estimated axes, on the vertical.
  const double sigma = (at_rest_ ? p_.rest_accel_factor : 1.0) * p_.accel_sigma_mps2 / kStandardGravity_mps2;
  const double norm = std::max(mean.norm(), 1.0);
  Row H = Row::Zero();
  H[0] = 1;
  correct(H, mean.y() / norm, sigma * sigma, settled_ ? p_.gate_sigma : 0.0);
  H.setZero(), H[1] = 1;
  correct(H, -mean.x() / norm, sigma * sigma, settled_ ? p_.gate_sigma : 0.0);
  settled_ = true;
  if (at_rest_) update_bias_at_rest(rate, std::max(p_.rest_sway_radps, rate_spread));
  reset_window();
}

void Filter::reset_window() {
  window_s_ = 0, window_count_ = 0;
  accel_sum_.setZero(), rate_sum_.setZero();
  accel_squares_ = rate_squares_ = 0;
}

/// The mean rate at rest measures the bias; a hand that stands still sways, with the spread of the rate as sigma.
void Filter::update_bias_at_rest(const Vector3d& rate, double sigma) {
  for (int i = 0; i < 3; ++i) {
    Row H = Row::Zero();
    H[3 + i] = 1;
    correct(H, rate[i] - bias_[i], sigma * sigma, p_.gate_sigma);
  }
}

/// One row of the Kalman update; no change if the innovation is outside the gate (0: no gate).
void Filter::correct(const Row& H, double innovation, double variance, double gate_sigma) {
  const Eigen::Matrix<double, kStates, 1> PHt = P_ * H.transpose();
  const double S = H.dot(PHt) + variance;
  if (gate_sigma > 0 && innovation * innovation > gate_sigma * gate_sigma * S) return;
  const Eigen::Matrix<double, kStates, 1> K = PHt / S, error = K * innovation;
  q_ = (exp_rotation(error.head<3>()) * q_).normalized();
  bias_ += error.segment<3>(3);
  field_off_rad_ += error[kFieldOff], street_off_rad_ += error[kStreetOff];
  iron_ += error.segment<3>(kIron);
  P_ -= K * PHt.transpose();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
}

/// True if the acceleration is calm (no walking) and both halves of the window have the same field strength.
bool Filter::is_quasi_static(double dt_s) const {
  const auto window = static_cast<size_t>(
      std::clamp(p_.field_window_s / std::max(dt_s, 1e-3), p_.min_window_samples, static_cast<double>(kNorms)));
  if (norms_.size() < window) return false;
  double halves[2] = {0, 0};
  for (size_t i = 0; i < 2 * (window / 2); ++i) halves[i < window / 2] += norms_.back(i);
  return calm_ && std::abs(halves[0] - halves[1]) < p_.field_change * halves[0];
}

/// Propagates a first-order Gauss-Markov process by `times` time constants.
void Filter::apply_gauss_markov(int state, double& value_rad, double times, double sigma_rad) {
  const double decay = std::exp(-times);
  value_rad *= decay;
  P_.row(state) *= decay;
  P_.col(state) *= decay;
  P_(state, state) += (1 - decay * decay) * sigma_rad * sigma_rad;
}

void Filter::update_magnetometer(const Vector3d& field, double dt_s) {
  const double norm = field.norm();
  if (!started_ || norm <= 0) return;
  norms_.push(norm);
  quasi_static_ = is_quasi_static(dt_s);
  seen_s_ += dt_s;
  strength_ += std::max(1 - std::exp(-dt_s / p_.strength_tau_s), std::min(1.0, dt_s / seen_s_)) * (norm - strength_);
  disturbed_ = std::abs(norm - strength_) > p_.unusual_strength * strength_;

  // The deviation of the field from north changes with the position.
  if (quasi_static_) {
    P_(kFieldOff, kFieldOff) += p_.field_random_walk * p_.field_random_walk * dt_s;
  } else {
    apply_gauss_markov(kFieldOff, field_off_rad_, dt_s / p_.field_off_s, p_.field_off_sigma_rad);
    apply_gauss_markov(kStreetOff, street_off_rad_, dt_s / p_.street_off_s, p_.street_off_sigma_rad);
  }

  field_sum_ += q_ * (field / strength_ - iron_);
  since_update_s_ += dt_s;
  if (since_update_s_ < p_.between_field_updates_s) return;
  update_field_heading(field_sum_ * dt_s / since_update_s_);
  field_sum_.setZero(), since_update_s_ = 0;
}

/// Update with the heading of the field, east of north: the sum of heading error, deviation of the field, and hard
/// iron.
void Filter::update_field_heading(const Vector3d& earth) {
  const double horizontal = earth.head<2>().norm(), heading = std::atan2(earth.x(), earth.y());
  if (horizontal < p_.min_horizontal) return;
  if (!has_heading_) {  // first measurement: initialise the heading with it
    has_heading_ = true;
    q_ = (exp_rotation({0, 0, heading}) * q_).normalized();
    P_.row(kHeading).setZero(), P_.col(kHeading).setZero();
    P_(kHeading, kHeading) = M_PI * M_PI;
    P_(kFieldOff, kFieldOff) = p_.field_off_sigma_rad * p_.field_off_sigma_rad;
    P_(kStreetOff, kStreetOff) = p_.street_off_sigma_rad * p_.street_off_sigma_rad;
    P_.block<3, 3>(kIron, kIron).diagonal().setConstant(p_.hard_iron_sigma * p_.hard_iron_sigma);
    return update_field_heading(exp_rotation({0, 0, heading}) * earth);
  }
  Row H = Row::Zero();
  H[kHeading] = 1, H[kFieldOff] = 1, H[kStreetOff] = 1;
  const Vector3d east_of_field(std::cos(heading) / horizontal, -std::sin(heading) / horizontal, 0);
  H.segment<3>(kIron) = east_of_field.transpose() * q_.toRotationMatrix();
  const double variance = p_.field_heading_sigma_rad * p_.field_heading_sigma_rad / (horizontal * horizontal);
  const double innovation = std::remainder(heading - field_off_rad_ - street_off_rad_, 2 * M_PI);
  // A large innovation indicates steel nearby: it is attributed to the field, beyond its usual variance.
  const double usual = (H * P_ * H.transpose()).value() + variance;
  if (innovation * innovation > p_.inflation_gate * usual) P_(kFieldOff, kFieldOff) += innovation * innovation;
  correct(H, innovation, variance, 0);
}

double Filter::heading_sigma() const { return std::sqrt(P_(kHeading, kHeading)); }
double Filter::inclination_sigma() const { return std::sqrt(std::max(P_(0, 0), P_(1, 1))); }

}  // namespace odograph::magyq
