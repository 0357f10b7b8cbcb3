// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/slant_distance/roof_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "sdk/math/time.hpp"

namespace odograph::slant_scale {

using Eigen::Vector3d;

void RoofPoints::begin_group(uint32_t group) {
  if (group_ == group) return;
  group_ = group;
  frames_.clear(), fixes_.clear();
}

void RoofPoints::add_points(int64_t t_ns, uint32_t group, std::vector<LandmarkPoint> points) {
  begin_group(group);
  frames_.push_back({t_ns, std::move(points), std::nullopt});
  while (seconds(t_ns - frames_.front().t_ns) > p_.history_s) frames_.pop_front();
}

void RoofPoints::add_orientation(int64_t t_ns, const Eigen::Quaterniond& q_n_c, uint32_t group) {
  begin_group(group);
  if (!frames_.empty() && frames_.back().t_ns == t_ns) frames_.back().q_n_c = q_n_c;
}

const RoofPoints::Frame* RoofPoints::nearest(int64_t t_ns) const {
  const Frame* best = nullptr;
  for (const Frame& frame : frames_)
    if (!best || std::abs(frame.t_ns - t_ns) < std::abs(best->t_ns - t_ns)) best = &frame;
  return best && std::abs(seconds(best->t_ns - t_ns)) <= p_.nearest_s ? best : nullptr;
}

void RoofPoints::add_fix(int64_t t_ns, const RoofPoint& roof) {
  const Frame* frame = nearest(t_ns);
  const double slant_m = roof.from_camera_n.norm();
  if (!frame || !(slant_m > 0) || (!roof.q_n_c && !frame->q_n_c)) return;
  const Eigen::Quaterniond q_n_c = roof.q_n_c ? *roof.q_n_c : *frame->q_n_c;
  const double wall_m = roof.from_camera_n.head<2>().norm(), roof_rad = std::atan2(-roof.from_camera_n.z(), wall_m);
  std::vector<LogScale> scales;
  for (const LandmarkPoint& point : frame->points) {
    const Vector3d x_n = q_n_c * point.p_c.cast<double>();
    const double distance = x_n.norm(), relative = static_cast<double>(point.distance_sigma) / distance;
    if (!(distance > 0) || !(relative < p_.max_relative_sigma)) continue;
    const double horizontal = x_n.head<2>().norm(), elevation_rad = std::atan2(-x_n.z(), horizontal);
    if (elevation_rad > std::min(p_.steepest_rad, roof_rad + p_.above_rad)) continue;
    if (elevation_rad < roof_rad - p_.below_rad) continue;
    if (x_n.head<2>().dot(roof.from_camera_n.head<2>()) < std::cos(p_.beside_rad) * horizontal * wall_m) continue;
    scales.push_back({t_ns, std::log(wall_m / horizontal), relative * relative});
  }
  if (scales.size() < p_.min_points) return;
  double variance = 0;
  for (const LogScale& scale : scales) variance += scale.variance / static_cast<double>(scales.size());
  LogScale fix = robust_mean(std::move(scales), p_.huber);
  fix.variance = std::max(fix.variance, variance / p_.independent);
  const double slant_sigma_m = roof.slant_sigma_m > 0 ? roof.slant_sigma_m : p_.slant_sigma_m;
  fix.t_ns = t_ns;
  fix.variance += std::pow(slant_sigma_m / slant_m, 2) + p_.model * p_.model;  // common to all landmarks
  fixes_.push_back(fix);
  while (fixes_.size() > 1 && seconds(t_ns - fixes_.front().t_ns) > window_s_) fixes_.pop_front();
}

/// From the weighted median by iteratively reweighted least squares. The variance is at least that of the scatter.
RoofPoints::LogScale RoofPoints::robust_mean(std::vector<LogScale> values, double huber) {
  std::sort(values.begin(), values.end(), [](const LogScale& a, const LogScale& b) { return a.value < b.value; });
  double total = 0, part = 0;
  for (const LogScale& v : values) total += 1 / v.variance;
  double mean = values.back().value;
  for (const LogScale& v : values)
    if ((part += 1 / v.variance) >= 0.5 * total) {
      mean = v.value;
      break;
    }
  double weight = 0, chi = 0;
  for (int iteration = 0; iteration < 5; ++iteration) {
    double sum = 0;
    weight = chi = 0;
    for (const LogScale& v : values) {
      const double z = std::abs(v.value - mean) / std::sqrt(v.variance);
      const double w = std::min(1.0, huber / std::max(z, 1e-9));
      sum += w / v.variance * v.value, weight += w / v.variance, chi += w * z * z;
    }
    mean = sum / weight;
  }
  const double scatter = values.size() > 1 ? chi / static_cast<double>(values.size() - 1) : 1.0;
  return {values.back().t_ns, mean, std::max(1.0, scatter) / weight};
}

std::optional<Scale> RoofPoints::scale_at(int64_t t_ns) const {
  std::vector<LogScale> recent;
  for (LogScale fix : fixes_) {
    const double age_s = seconds(t_ns - fix.t_ns);
    if (age_s > window_s_ && fix.t_ns != fixes_.back().t_ns) continue;  // the newest remains, with a growing sigma
    fix.variance += std::pow(scale_drift_ * std::max(0.0, age_s) / window_s_, 2);
    recent.push_back(fix);
  }
  if (recent.empty()) return std::nullopt;
  const LogScale mean = robust_mean(std::move(recent), p_.huber);
  const double scale = std::exp(mean.value);
  return Scale{scale, scale * std::hypot(std::sqrt(mean.variance), p_.model)};
}

}  // namespace odograph::slant_scale
