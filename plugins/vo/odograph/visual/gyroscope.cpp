// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/gyroscope.hpp"

#include <algorithm>
#include <cmath>

#include "plugins/shared/rotation.hpp"

namespace odograph::vo {
using so3::exp_rotation;
using so3::log_rotation;

void Gyroscope::add(int64_t t_ns, const Eigen::Vector3d& rate_c) {
  if (!samples_.empty() && t_ns <= samples_.back(0).t_ns) return;
  samples_.push({t_ns, rate_c});
}

std::optional<GyroRotation> Gyroscope::between(int64_t from_ns, int64_t to_ns, const Eigen::Vector3d& bias_c) const {
  const size_t kept = samples_.size();
  size_t i = 0;  // samples later than from_ns
  while (i < kept && samples_.back(i).t_ns > from_ns) ++i;
  if (i == 0) return std::nullopt;
  GyroRotation result{Eigen::Quaterniond::Identity(), Eigen::Matrix3d::Zero(), 0};
  int64_t t = from_ns;
  const auto rotate = [&](const Eigen::Vector3d& rate, int64_t until_ns) {
    const double dt_s = static_cast<double>(until_ns - t) * 1e-9;
    const Eigen::Quaterniond step = exp_rotation((rate - bias_c) * dt_s);
    result.q_c0_c1 = result.q_c0_c1 * step;
    result.by_bias = step.conjugate().toRotationMatrix() * result.by_bias - dt_s * Eigen::Matrix3d::Identity();
    t = until_ns;
  };
  // A sample stands for the time up to it, as the mean of it and the one before where that is at hand.
  for (; i > 0 && t < to_ns; --i) {
    const Sample& sample = samples_.back(i - 1);
    if (sample.t_ns - t > p_.longest_gap_ns) return std::nullopt;
    const Eigen::Vector3d before = i < kept ? samples_.back(i).rate_c : sample.rate_c;
    rotate(0.5 * (before + sample.rate_c), std::min(sample.t_ns, to_ns));
  }
  if (to_ns - t > p_.longest_gap_ns) return std::nullopt;
  if (t < to_ns) rotate(samples_.back(0).rate_c, to_ns);
  const double dt_s = static_cast<double>(to_ns - from_ns) * 1e-9;
  result.sigma_rad = std::sqrt(p_.angle_random_walk * p_.angle_random_walk * dt_s + p_.timing_rad * p_.timing_rad) +
                     p_.scale_error * log_rotation(result.q_c0_c1).norm();
  return result;
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
