// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/inertial/inertial_scale.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"

namespace odograph::inertial_scale {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

double seconds(int64_t ns) { return static_cast<double>(ns) * 1e-9; }
double squared(double x) { return x * x; }

}  // namespace

void InertialScale::set_camera(const Mount& mount) {
  const bool same = mount.q_b_c.coeffs() == mount_.q_b_c.coeffs() && mount.p_b_c == mount_.p_b_c;
  if (!same) last_ns_ = INT64_MIN;
  mount_ = mount;
}

void InertialScale::add_imu(int64_t t_ns, const Vector3d& gyro_b, const Vector3d& accel_b) {
  if (samples_.empty() || t_ns > samples_.back(0).t_ns) samples_.push({t_ns, gyro_b, accel_b});
}

void InertialScale::add_motion(const Motion& motion) {
  if (pending_ && pending_->group == motion.group) {
    use(*pending_);
  } else {
    last_ns_ = INT64_MIN;
    variance_ = -1, known_ = false, rejected_ = 0;
  }
  pending_ = motion;
}

void InertialScale::use(const Motion& m) {
  const double dt_s = seconds(m.t_ns - m.from_ns);
  if (dt_s <= 0) return;
  predict(m, dt_s);
  const bool continues = m.from_ns == last_ns_ && m.translates && orient(m);
  last_ns_ = INT64_MIN;
  if (!m.translates) return;
  if (!continues) q_n_b_ = (m.q_n_c0 * mount_.q_b_c.conjugate()).normalized();
  const Quaterniond q_n_c0 = q_n_b_ * mount_.q_b_c;
  if (!integrate(m.from_ns, m.t_ns)) return;
  last_ns_ = m.t_ns;
  if (continues) {
    const Quaterniond gyro_c0_c1 = q_n_c0.conjugate() * q_n_b_ * mount_.q_b_c;
    y_n_ += q_n_c0 * m.p_c0_c1;
    beta_n_ += q_n_c0 * log_rotation(m.q_c0_c1 * gyro_c0_c1.conjugate()).cross(Vector3d::UnitZ());
  } else {  // a window starts with the later frame of this motion
    window_.clear();
    alpha_n_.setZero(), rate_n_.setZero(), y_n_.setZero(), beta_n_.setZero();
  }
  add_frame(m.t_ns);
}

/// Aligns the gyroscope's orientation slowly with the host's, so that an error of the host's in a single frame does not
/// tilt the acceleration. False if the host's orientation has jumped.
bool InertialScale::orient(const Motion& m) {
  const Vector3d off_n = log_rotation(m.q_n_c0 * mount_.q_b_c.conjugate() * q_n_b_.conjugate());
  if (!(off_n.norm() < p_.jump_rad)) return false;
  const double share = std::min(1.0, seconds(m.t_ns - m.from_ns) / p_.anchor_s);
  q_n_b_ = (exp_rotation(share * off_n) * q_n_b_).normalized();
  return true;
}

/// Integrates the IMU to orientation and twice integrated acceleration in n; false if samples are missing. Rates are
/// linear between samples and constant after the newest one.
bool InertialScale::integrate(int64_t from_ns, int64_t to_ns) {
  size_t i = 0;  // index of the newest sample at or before the start
  while (i < samples_.size() && samples_.back(i).t_ns > from_ns) ++i;
  if (i == samples_.size()) return false;
  for (int64_t t_ns = from_ns; t_ns < to_ns;) {
    const Sample& a = samples_.back(i);
    const Sample& b = samples_.back(i > 0 ? i - 1 : 0);
    const int64_t until_ns = i > 0 ? std::min(b.t_ns, to_ns) : to_ns;
    if (seconds((i > 0 ? b.t_ns : to_ns) - a.t_ns) > p_.longest_gap_s) return false;
    const double dt = seconds(until_ns - t_ns);
    const double w = i > 0 ? (seconds(t_ns - a.t_ns) + 0.5 * dt) / seconds(b.t_ns - a.t_ns) : 0.0;
    const Vector3d half_rotation = 0.5 * dt * (a.gyro_b + w * (b.gyro_b - a.gyro_b));
    const Quaterniond middle = q_n_b_ * exp_rotation(half_rotation);
    Vector3d accel_n = middle * (a.accel_b + w * (b.accel_b - a.accel_b));
    accel_n.z() += p_.gravity_mps2;
    alpha_n_ += dt * rate_n_ + 0.5 * dt * dt * accel_n;
    rate_n_ += dt * accel_n;
    q_n_b_ = (middle * exp_rotation(half_rotation)).normalized();
    t_ns = until_ns;
    if (i > 0) --i;
  }
  return true;
}

void InertialScale::add_frame(int64_t t_ns) {
  if (window_.empty()) window_ns_ = t_ns;
  const double t_s = seconds(t_ns - window_ns_);
  if (!window_.empty() && t_s - window_.last_s() < p_.frame_spacing_s) return;
  window_.add({t_s, alpha_n_ + q_n_b_ * mount_.p_b_c, y_n_, beta_n_});
  if (t_s < p_.window_s) return;
  if (const auto window = window_.solve()) update(*window);
  last_ns_ = INT64_MIN;  // the next window shares no frame with this one
}

/// Random walk of the log-scale with the path, and with time while standing; sigma of r = 1/scale is r times as large.
void InertialScale::predict(const Motion& m, double dt_s) {
  if (variance_ < 0) return;
  const double r = std::max(inverse_scale_, std::sqrt(variance_));
  const double length = m.translates ? m.p_c0_c1.norm() : 0;  // up to scale; length / r in metres
  variance_ += squared(p_.scale_walk) * r * length;
  if (length < r * p_.standing_mps * dt_s) variance_ += squared(p_.standing_walk * r) * dt_s;
}

void InertialScale::update(const WindowScale& window) {
  // The window's mean scale serves as the scale at its end.
  const double r = std::abs(window.inverse_scale), innovation = window.inverse_scale - inverse_scale_;
  const double noise = squared(window.sigma) + squared(p_.scale_walk) * r * window.path / 3;
  const bool fits = variance_ >= 0 && squared(innovation) <= p_.gate * (variance_ + noise);
  if (variance_ >= 0 && !fits && ++rejected_ < p_.max_rejected) return;
  if (!fits) known_ = false;
  const double gain = fits ? variance_ / (variance_ + noise) : 1;
  inverse_scale_ += gain * innovation;
  variance_ = gain * noise;
  rejected_ = 0;
  const auto now = estimate();
  known_ = now && (known_ || now->relative_sigma < p_.start_sigma);
}

std::optional<Scale> InertialScale::estimate() const {
  if (variance_ < 0 || inverse_scale_ <= 0) return std::nullopt;
  return Scale{1 / inverse_scale_, std::hypot(std::sqrt(variance_) / inverse_scale_, p_.common_sigma)};
}

}  // namespace odograph::inertial_scale
