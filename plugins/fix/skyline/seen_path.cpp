// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/seen_path.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace odograph::skyline {

Eigen::Vector3d SeenPath::Seen::place(const Eigen::Vector3d& newest_n, double yaw_rad) const {
  return newest_n + Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) * offset_n;
}

void SeenPath::set(const std::vector<SkyEdge>& edges, const Eigen::Vector3d& p_n, const Eigen::Quaterniond& q_n_c,
                   const std::vector<View>& older, double yaw_reach_rad) {
  seen_.resize(1 + older.size());
  seen_[0].skyline.set(edges, q_n_c);
  seen_[0].offset_n.setZero();
  for (size_t i = 0; i < older.size(); ++i) {
    seen_[i + 1].skyline.set(older[i].edges, older[i].q_n_c);
    seen_[i + 1].offset_n = older[i].p_n - p_n;
  }
  for (Seen& seen : seen_) {
    seen.sector = Sector::all();
    seen.computed_n.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (!is_path()) continue;
    const auto [from, to] = seen.skyline.azimuths();
    const double beside = std::min(yaw_reach_rad, std::numbers::pi) + p_.beside_rad;
    seen.sector = Sector::between(from - beside, to + beside);
  }
}

size_t SeenPath::directions() const {
  size_t n = 0;
  for (const Seen& seen : seen_) n += seen.skyline.size();
  return n;
}

double SeenPath::lowest_rad() const {
  double lowest = seen_.front().skyline.lowest_rad();
  for (const Seen& seen : seen_) lowest = std::min(lowest, seen.skyline.lowest_rad());
  return lowest;
}

double SeenPath::total_weight() const {
  double total = 0;
  for (const Seen& seen : seen_) total += seen.skyline.total_weight();
  return total;
}

double SeenPath::correlated() const { return is_path() ? p_.correlated : 1; }

Eigen::Vector3d SeenPath::middle_n() const {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
  for (const Seen& seen : seen_) low = low.cwiseMin(seen.offset_n), high = high.cwiseMax(seen.offset_n);
  return 0.5 * (low + high);
}

double SeenPath::half_length_m() const {
  double farthest = 0;
  for (const Seen& seen : seen_) farthest = std::max(farthest, (seen.offset_n - middle_n()).norm());
  return farthest;
}

bool SeenPath::must_recompute(const Seen& seen, const Eigen::Vector3d& newest_n, double yaw_rad) const {
  return !((seen.place(newest_n, yaw_rad) - seen.computed_n).norm() < p_.moved_m);
}

uint64_t SeenPath::work_to_recompute(const City& city, const Eigen::Vector3d& newest_n, double yaw_rad,
                                     bool recompute_all) const {
  uint64_t work = 0;
  for (const Seen& seen : seen_)
    if (recompute_all || (is_path() && must_recompute(seen, newest_n, yaw_rad))) work += city.quick_work(seen.sector);
  return work;
}

void SeenPath::look(const City& city, const Eigen::Vector3d& newest_n, double yaw_rad, bool recompute_all) {
  for (Seen& seen : seen_) {
    if (!recompute_all && (!is_path() || !must_recompute(seen, newest_n, yaw_rad))) continue;
    seen.computed_n = seen.place(newest_n, yaw_rad);
    city.quick_horizon(seen.computed_n, seen.horizon, seen.sector);
  }
}

double SeenPath::loss(const Guess& guess, double max_rad) const {
  SeenSkyline::Sum sum;
  for (const Seen& seen : seen_) seen.skyline.add_loss(seen.horizon, guess, max_rad, sum);
  return sum.mean();
}

double SeenPath::agreement(const Guess& guess, double bound_rad) const {
  SeenSkyline::Sum sum;
  for (const Seen& seen : seen_) seen.skyline.add_agreement(seen.horizon, guess, bound_rad, sum);
  return sum.weight > 0 ? sum.value / sum.weight : 0;
}

}  // namespace odograph::skyline
