// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/gait/gait_signal.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"

namespace odograph::gait {

void GaitSignal::update(int64_t t_ns, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
  const double norm = accel.norm();
  if (!started_) {
    started_ = true;
    t_ns_ = t_ns;
    smooth_ = {norm, norm};
    mean_ = norm;
    delay_ns_ = nanoseconds(p_.smooth_tau_s);
    return;
  }
  const double dt = std::min(0.2, seconds(t_ns - t_ns_));
  t_ns_ = t_ns;
  if (dt <= 0) return;
  time_s_ += dt;
  const auto gain = [dt](double tau) { return 1.0 - std::exp(-dt / tau); };
  const double k = gain(0.5 * p_.smooth_tau_s);
  smooth_[0] += k * (norm - smooth_[0]);
  smooth_[1] += k * (smooth_[0] - smooth_[1]);
  mean_ += gain(std::min(p_.mean_tau_s, std::max(0.05, time_s_))) * (norm - mean_);
  const double s = gain(p_.spread_tau_s);
  const double deviation = norm - mean_;
  variance_ += s * (deviation * deviation - variance_);
  gyro_norm_ += s * (gyro.norm() - gyro_norm_);
}

double GaitSignal::accel_spread() const { return std::sqrt(variance_); }

Carrying GaitSignal::carrying() const {
  if (time_s_ < 0.3) return Carrying::unknown;
  if (accel_spread() < p_.still_accel_mps2) return Carrying::still;
  return gyro_norm_ > p_.swing_gyro_radps ? Carrying::swinging : Carrying::texting;
}

}  // namespace odograph::gait
