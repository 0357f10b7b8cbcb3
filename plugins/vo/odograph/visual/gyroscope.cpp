// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/gyroscope.hpp"

#include <cmath>

#include "sdk/math/rotation_integral.hpp"

namespace odograph::vo {

void Gyroscope::add(int64_t t_ns, const Eigen::Vector3d& rate_c) {
  if (!samples_.empty() && t_ns <= samples_.back(0).t_ns) return;
  samples_.push({t_ns, rate_c});
}

/// A sample covers the interval up to it, with the mean of it and the previous one if there is one.
std::optional<GyroRotation> Gyroscope::between(int64_t from_ns, int64_t to_ns, const Eigen::Vector3d& bias_c) const {
  if (samples_.empty() || samples_.back(0).t_ns <= from_ns) return std::nullopt;
  const auto integral = integrate_rotation(samples_, from_ns, to_ns, p_.longest_gap_ns,
                                           [&](const Sample& before, const Sample& after) -> Eigen::Vector3d {
                                             return 0.5 * (before.rate_c + after.rate_c) - bias_c;
                                           });
  if (!integral) return std::nullopt;
  const double dt_s = seconds(to_ns - from_ns);
  const double sigma_rad =
      std::sqrt(p_.angle_random_walk * p_.angle_random_walk * dt_s + p_.timing_rad * p_.timing_rad) +
      p_.scale_error * log_rotation(integral->q_b0_b1).norm();
  return GyroRotation{integral->q_b0_b1, integral->by_bias, sigma_rad};
}

std::optional<Eigen::Vector3d> Gyroscope::rate(int64_t t_ns) const {
  const size_t kept = samples_.size();
  for (size_t i = 0; i < kept; ++i)
    if (samples_.back(i).t_ns <= t_ns) {
      if (t_ns - samples_.back(i).t_ns > p_.longest_gap_ns) return std::nullopt;
      return samples_.back(i).rate_c;
    }
  return std::nullopt;
}

}  // namespace odograph::vo
