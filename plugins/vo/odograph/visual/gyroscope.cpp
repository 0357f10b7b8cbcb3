// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/gyroscope.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::vo {
namespace {

constexpr int64_t kLongestGap_ns = 60'000'000;
constexpr double kNoise = 0.0005;      // rad/sqrt(s)
constexpr double kByAngle = 0.005;     // scale and misalignment of a phone's gyroscope
constexpr double kLeast_rad = 0.0002;  // time stamps

}  // namespace

Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& angle) {
  const double norm = angle.norm();
  return norm > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(norm, angle / norm)) : Eigen::Quaterniond::Identity();
}

Eigen::Vector3d log_rotation(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2 * q.vec();
  return 2 * std::atan2(q.w() < 0 ? -sine : sine, std::abs(q.w())) / sine * q.vec();
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

void Gyroscope::add(int64_t t_ns, const Eigen::Vector3d& rate_c) {
  if (count_ > 0 && t_ns <= back(0).t_ns) return;
  samples_[count_++ % samples_.size()] = {t_ns, rate_c};
}

std::optional<GyroRotation> Gyroscope::between(int64_t from_ns, int64_t to_ns, const Eigen::Vector3d& bias_c) const {
  const size_t kept = std::min(count_, samples_.size());
  size_t i = 0;  // samples later than from_ns
  while (i < kept && back(i).t_ns > from_ns) ++i;
  if (i == 0) return std::nullopt;
  GyroRotation result{Eigen::Quaterniond::Identity(), Eigen::Matrix3d::Zero(), 0};
  int64_t t = from_ns;
  const auto turn = [&](const Eigen::Vector3d& rate, int64_t until_ns) {
    const double dt_s = static_cast<double>(until_ns - t) * 1e-9;
    const Eigen::Quaterniond step = exp_rotation((rate - bias_c) * dt_s);
    result.q_c0_c1 = result.q_c0_c1 * step;
    result.by_bias = step.conjugate().toRotationMatrix() * result.by_bias - dt_s * Eigen::Matrix3d::Identity();
    t = until_ns;
  };
  // A sample stands for the time up to it: interpolated with the one before where that is at hand.
  for (; i > 0 && t < to_ns; --i) {
    const Sample& sample = back(i - 1);
    if (sample.t_ns - t > kLongestGap_ns) return std::nullopt;
    const Eigen::Vector3d before = i < kept ? back(i).rate_c : sample.rate_c;
    turn(0.5 * (before + sample.rate_c), std::min(sample.t_ns, to_ns));
  }
  if (to_ns - t > kLongestGap_ns) return std::nullopt;
  if (t < to_ns) turn(back(0).rate_c, to_ns);
  const double dt_s = static_cast<double>(to_ns - from_ns) * 1e-9;
  result.sigma_rad =
      std::sqrt(kNoise * kNoise * dt_s + kLeast_rad * kLeast_rad) + kByAngle * log_rotation(result.q_c0_c1).norm();
  return result;
}

std::optional<Eigen::Vector3d> Gyroscope::rate(int64_t t_ns) const {
  const size_t kept = std::min(count_, samples_.size());
  for (size_t i = 0; i < kept; ++i)
    if (back(i).t_ns <= t_ns) {
      if (t_ns - back(i).t_ns > kLongestGap_ns) return std::nullopt;
      return back(i).rate_c;
    }
  return std::nullopt;
}

}  // namespace odograph::vo
