// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/slant_distance/literal_scale.hpp"

#include "sdk/math/time.hpp"

namespace odograph::slant_scale {
namespace {

using Eigen::Vector3d;

constexpr double kMinBaseline = 1e-6;  // eq. (5) divides by it

}  // namespace

void LiteralScale::start_at(const Vector3d& p_n) {
  if (began_at_start_)
    for (Point& point : path_) point.p += p_n - start_n_;
  start_n_ = p_n;
}

void LiteralScale::add_motion(int64_t from_ns, int64_t t_ns, const Vector3d& d_n, uint32_t group) {
  if (group_ && *group_ != group) {
    path_.clear();
    if (corrected_) began_at_start_ = false;
  }
  group_ = group;
  if (path_.empty()) path_.push_back({from_ns, began_at_start_ ? start_n_ : last_position_});
  path_.push_back({t_ns, path_.back().p + d_n});
  frame_displacement_ = d_n.norm();
  while (seconds(t_ns - path_.front().t_ns) > kHistory_s) path_.pop_front();
}

std::optional<Vector3d> LiteralScale::previous_position(int64_t t_ns) const {
  for (auto point = path_.rbegin(); point != path_.rend(); ++point)
    if (point->t_ns < t_ns) return point->p;
  return std::nullopt;
}

void LiteralScale::add_position(int64_t t_ns, const Vector3d& p_n, double slant_distance_m) {
  last_position_ = p_n;
  const auto previous = previous_position(t_ns);
  if (!previous) return;
  const double baseline = (p_n - *previous).norm();
  if (baseline > kMinBaseline) scale_ = slant_distance_m / baseline, corrected_ = true;
}

}  // namespace odograph::slant_scale
