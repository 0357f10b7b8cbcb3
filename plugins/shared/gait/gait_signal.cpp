// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/gait/gait_signal.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
  const double e = gain(p_.energy_tau_s), deviation = norm - mean_;
  accel_energy_ += e * (deviation * deviation - accel_energy_);
  swing_energy_ += gain(p_.swing_tau_s) * (gyro.squaredNorm() - swing_energy_);
  const double before =
      std::exchange(gyro_smooth_, gyro_smooth_ + gain(p_.smooth_tau_s) * (gyro.norm() - gyro_smooth_));
  gyro_peaked_ = gyro_peaked_ || (gyro_rises_ && gyro_smooth_ < before && before * before > swing_energy_);
  gyro_rises_ = gyro_smooth_ > before;
}

}  // namespace odograph::gait
