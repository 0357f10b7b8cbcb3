// SPDX-License-Identifier: Apache-2.0
#include "plugins/attitude/vqf/vqf.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/rotation.hpp"

namespace odograph::vqf {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

/// Shortest rotation from a unit vector to the vertical.
Quaterniond to_vertical(const Vector3d& up) {
  if (up.z() < -1.0 + 1e-9) return {0.0, 1.0, 0.0, 0.0};
  const double w = std::sqrt(0.5 * (up.z() + 1.0));
  return {w, 0.5 * up.y() / w, -0.5 * up.x() / w, 0.0};
}

}  // namespace

void Filter::update(const Vector3d& gyro, const Vector3d& accel, double dt_s) {
  if (!started_) {
    const double norm = accel.norm();
    if (norm < 1.0) return;  // free fall or a defective sensor: no vertical to start from
    started_ = true;
    q_accel_ = to_vertical(accel / norm);
    bias_covariance_ = Matrix3d::Identity() * p_.bias_sigma_init_radps * p_.bias_sigma_init_radps;
    accel_low_.update(accel, p_.tau_acc_s, dt_s);
    return;
  }
  time_s_ += dt_s;
  update_rest(gyro, accel, dt_s);
  q_gyro_ = (q_gyro_ * exp_rotation((gyro - bias_) * dt_s)).normalized();

  // After saturation the inclination must be re-initialised.
  if (gyro.norm() > p_.saturation_gyro_radps || accel.norm() > p_.saturation_accel_mps2) {
    saturated_ = true;
    heading_sigma_ += 0.1 * gyro.norm() * dt_s;
    return;
  }
  if (std::exchange(saturated_, false)) accel_low_.started = false, time_s_ = dt_s;

  // Inclination correction: the acceleration, averaged in the nearly inertial frame, points up. During the first
  // tau_acc_s the average covers all samples, which converges much faster.
  const double tau = std::min(p_.tau_acc_s, std::max(time_s_, dt_s));
  const Vector3d accel_low = accel_low_.update(q_gyro_ * accel, tau, dt_s);
  const double norm = accel_low.norm();
  if (norm < 1e-3) return;
  const Vector3d accel_earth = (q_accel_ * accel_low) / norm;
  q_accel_ = (to_vertical(accel_earth) * q_accel_).normalized();
  update_bias(accel_earth, dt_s);
  heading_sigma_ += (bias_sigma() * dt_s);
}

void Filter::update_rest(const Vector3d& gyro, const Vector3d& accel, double dt_s) {
  const Vector3d gyro_low = rest_gyro_low_.update(gyro, p_.rest_filter_tau_s, dt_s);
  const Vector3d accel_low = rest_accel_low_.update(accel, p_.rest_filter_tau_s, dt_s);
  const Vector3d sway = gyro_low - rest_gyro_slow_.update(gyro_low, p_.rest_sway_tau_s, dt_s);
  const double k = 1.0 - std::exp(-dt_s / p_.rest_sway_tau_s);
  rest_sway_variance_ += k * (sway.squaredNorm() - rest_sway_variance_);
  const bool still = (gyro - gyro_low).norm() < p_.rest_gyro_radps && (accel - accel_low).norm() < p_.rest_accel_mps2 &&
                     gyro_low.cwiseAbs().maxCoeff() < p_.bias_clip_radps &&
                     rest_sway_variance_ < p_.rest_sway_radps * p_.rest_sway_radps;
  rest_time_s_ = still ? rest_time_s_ + dt_s : 0.0;
}

/// The paper's Kalman filter with the bias as state. At rest the gyroscope measures it; in motion the inclination
/// correction observes the two components that tilt, and a weak zero measurement constrains the third.
void Filter::update_bias(const Vector3d& accel_earth, double dt_s) {
  const double growth = 0.001745;  // 0.1 deg/s within bias_forgetting_s
  const double V = growth * growth * dt_s / p_.bias_forgetting_s;
  const auto weight = [V](double sigma) { return sigma * sigma * sigma * sigma / V + sigma * sigma; };

  const Matrix3d R_now = (q_accel_ * q_gyro_).toRotationMatrix();
  const Vector3d bias_earth = bias_low_.update(R_now * bias_, p_.tau_acc_s, dt_s);
  Matrix3d R = rotation_low_.update(R_now, p_.tau_acc_s, dt_s);
  Vector3d error, w;
  if (at_rest()) {
    error = rest_gyro_low_.second - bias_;
    R.setIdentity();
    w.setConstant(weight(p_.bias_sigma_rest_radps));
  } else {
    error = bias_earth - R * bias_;
    error.x() -= accel_earth.y() / dt_s;
    error.y() += accel_earth.x() / dt_s;
    error.z() = -(R * bias_).z();
    const double motion = weight(p_.bias_sigma_motion_radps);
    w = Vector3d(motion, motion, motion / std::max(p_.bias_vertical_forgetting, 1e-10));
  }
  const double P0 = p_.bias_sigma_init_radps * p_.bias_sigma_init_radps;
  for (int i = 0; i < 3; ++i)
    if (bias_covariance_(i, i) < P0) bias_covariance_(i, i) += V;
  error = error.cwiseMax(-p_.bias_clip_radps).cwiseMin(p_.bias_clip_radps);
  const Matrix3d S = Matrix3d(w.asDiagonal()) + R * bias_covariance_ * R.transpose();
  const Matrix3d K = bias_covariance_ * R.transpose() * S.inverse();
  bias_ += K * error;
  bias_covariance_ -= K * R * bias_covariance_;
  bias_ = bias_.cwiseMax(-p_.bias_clip_radps).cwiseMin(p_.bias_clip_radps);
}

void Filter::update_magnetometer(const Vector3d& field, double dt_s) {
  const double norm = field.norm();
  if (!started_ || norm <= 0) return;
  const Vector3d earth = (q_accel_ * q_gyro_) * field;
  const double dip = -std::asin(std::clamp(earth.z() / norm, -1.0, 1.0));
  const auto close = [&](double reference_norm, double reference_dip) {
    return std::abs(norm - reference_norm) < p_.mag_norm_tolerance * reference_norm &&
           std::abs(dip - reference_dip) < p_.mag_dip_tolerance_rad;
  };
  if (mag_norm_ <= 0) mag_norm_ = norm, mag_dip_rad_ = dip;
  mag_disturbed_ = !close(mag_norm_, mag_dip_rad_);
  if (!mag_disturbed_) {
    const double k = 1.0 - std::exp(-dt_s / p_.mag_ref_tau_s);
    mag_norm_ += k * (norm - mag_norm_);
    mag_dip_rad_ += k * (dip - mag_dip_rad_);
  }
  if (close(mag_candidate_norm_, mag_candidate_dip_rad_))
    mag_candidate_s_ += dt_s;
  else
    mag_candidate_norm_ = norm, mag_candidate_dip_rad_ = dip, mag_candidate_s_ = 0.0;
  if (mag_disturbed_ && mag_candidate_s_ > p_.mag_new_s) {
    mag_norm_ = mag_candidate_norm_, mag_dip_rad_ = mag_candidate_dip_rad_;
    mag_candidate_s_ = 0.0;
  }
  if (mag_disturbed_ && has_heading_) return;

  // Heading correction (eq. (8) of the paper): deviation of the horizontal field from north.
  const double off = std::remainder(std::atan2(earth.x(), earth.y()) - delta_rad_, 2 * kPi);
  mag_time_s_ += dt_s;
  const double k = std::max(1.0 - std::exp(-dt_s / p_.tau_mag_s), std::min(1.0, dt_s / mag_time_s_));
  delta_rad_ = std::remainder(delta_rad_ + k * off, 2 * kPi);
  if (!has_heading_) heading_sigma_ = 0.175;
  has_heading_ = true;
  heading_sigma_ += k * (0.05 - heading_sigma_);
}

Quaterniond Filter::orientation() const { return (exp_rotation({0, 0, delta_rad_}) * q_accel_ * q_gyro_).normalized(); }

double Filter::bias_sigma() const { return std::sqrt(bias_covariance_.diagonal().maxCoeff()); }

double Filter::inclination_sigma() const { return 0.0175 + 0.1 * std::exp(-time_s_ / p_.tau_acc_s); }

}  // namespace odograph::vqf
