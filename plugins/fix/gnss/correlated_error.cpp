// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/gnss/correlated_error.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"

namespace odograph::gnss {

void CorrelatedError::on_path(int64_t, const Eigen::Vector2d& path_m, double heading_sigma_rad) {
  const double moved = has_path_ ? (path_m - path_).norm() : 0.0;
  // The path was corrected: moves the path position of the last comparison with it.
  if (moved > p_.correction_m)
    last_.difference -= path_m - path_;
  else
    walked_m_ += moved;
  path_ = path_m, has_path_ = true;
  heading_sigma_rad_ = heading_sigma_rad;
}

CorrelatedError::Corrected CorrelatedError::on_position(int64_t t_ns, const Eigen::Vector2d& position_m,
                                                        double sigma_m) {
  const double dt = has_last_ ? seconds(t_ns - last_ns_) : 0.0;
  const double decay = std::exp(-dt / p_.bias_s);
  bias_ *= decay, bias_variance_m2_ *= decay * decay;
  Corrected result{position_m - bias_, sigma_m, false};
  const Eigen::Vector2d difference = result.position_m - path_;
  if (has_last_ && has_path_ && dt < p_.longest_s) {
    const double walked = walked_m_ - last_.walked_m;
    const double by_process = 2 * sigma_m * sigma_m * (1 - std::exp(-dt / p_.correlation_s));
    const double by_path = walked * std::hypot(p_.path_error, std::min(p_.max_heading_rad, heading_sigma_rad_));
    const double variance = by_process + by_path * by_path + p_.own_noise_m * p_.own_noise_m;
    const Eigen::Vector2d change = difference - last_.difference;
    if (change.squaredNorm() > p_.gate_sigma * p_.gate_sigma * variance) {
      bias_ += change;
      bias_variance_m2_ += variance;
      result.position_m -= change;
      result.jumped = true;
    }
  }
  // The decayed part of a bias is still in the position, correlated over the time constant of the bias.
  const double alike = dt > 0 ? 1 / std::tanh(dt / (2 * p_.correlation_s)) : 1.0;
  const double alike_bias = dt > 0 ? 1 / std::tanh(dt / (2 * p_.bias_s)) : 1.0;
  result.sigma_m = std::sqrt(sigma_m * sigma_m * alike +
                             alike_bias * (bias_variance_m2_ + (decay < 1 ? bias_.squaredNorm() : 0.0) *
                                                                   (p_.decay_sigma_part * p_.decay_sigma_part)));
  last_ = {t_ns, result.position_m - path_, walked_m_};
  last_ns_ = t_ns, has_last_ = true;
  return result;
}

}  // namespace odograph::gnss
