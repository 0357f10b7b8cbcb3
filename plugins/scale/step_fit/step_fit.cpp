// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/step_fit/step_fit.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::step_fit {
void StepFit::add_motion(int64_t from_ns, int64_t to_ns, const Eigen::Vector2d& d_n, uint32_t group) {
  if (group_ != group || path_.empty()) {
    group_ = group;
    path_.clear();
    recent_count_ = 0;
    variance_ = -1;
    path_.push({from_ns, Eigen::Vector2d::Zero()});
  }
  const Eigen::Vector2d before = path_.back(0).p;
  path_.push({to_ns, before + d_n});
}

std::optional<Eigen::Vector2d> StepFit::at(int64_t t_ns) const {
  if (path_.empty() || t_ns > path_.back(0).t_ns) return std::nullopt;
  for (size_t i = 1; i < path_.size(); ++i) {
    if (path_.back(i).t_ns > t_ns) continue;
    const Point &a = path_.back(i), &b = path_.back(i - 1);
    const double w = b.t_ns > a.t_ns ? static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns) : 0.0;
    return Eigen::Vector2d(a.p + w * (b.p - a.p));
  }
  return std::nullopt;
}

/// A standing person's moving hand produces steps as well, but no displacement: a walk is three consecutive steps with
/// similar odometry displacements in a straight line.
bool StepFit::is_walk() const {
  if (recent_count_ < recent_.size()) return false;
  double shortest = 1e300, longest = 0, sum = 0;
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();
  for (const Step& step : recent_) {
    const double d = step.d.norm();
    shortest = std::min(shortest, d), longest = std::max(longest, d), sum += d, displacement += step.d;
  }
  return longest < p_.alike * shortest && displacement.norm() > p_.straight * sum;
}

bool StepFit::add_step(int64_t start_ns, int64_t end_ns, double length_m, double sigma_m) {
  const auto start = at(start_ns), end = at(end_ns);
  if (!start || !end || length_m <= 0) return false;
  if (start_ns - last_end_ns_ > p_.pause_ns) recent_count_ = 0;
  last_end_ns_ = end_ns;
  const bool walked = is_walk();
  recent_[recent_count_++ % recent_.size()] = {*end - *start, length_m, sigma_m / length_m};
  if (!is_walk()) return false;
  if (walked) return take(recent_[(recent_count_ - 1) % recent_.size()]);
  for (const Step& step : recent_) take(step);  // the earlier ones are accepted with it
  return true;
}

bool StepFit::take(const Step& step) {
  const double z = std::log(step.length_m / step.d.norm());
  double r = step.relative_sigma * step.relative_sigma + p_.timing * p_.timing;
  if (variance_ < 0) {
    log_scale_ = z, variance_ = r;
    return true;
  }
  variance_ += drift_ * drift_;
  const double innovation = z - log_scale_, off = std::abs(innovation) / std::sqrt(variance_ + r);
  if (off > p_.huber) r = (variance_ + r) * off / p_.huber - variance_;
  const double gain = variance_ / (variance_ + r);
  log_scale_ += gain * innovation;
  variance_ *= 1 - gain;
  return true;
}

std::optional<Scale> StepFit::scale() const {
  if (variance_ < 0) return std::nullopt;
  return Scale{std::exp(log_scale_), std::sqrt(variance_ + common_ * common_)};
}

}  // namespace odograph::step_fit
