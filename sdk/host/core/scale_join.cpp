// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/scale_join.hpp"

#include <algorithm>
#include <cmath>

namespace odograph {

bool ScaleJoin::holds(const odo_scale& scale) const {
  return scale.scale_group == group_ && scale.valid_from_ns < t_ns_ && t_ns_ <= scale.valid_to_ns;
}

ScaleUse ScaleJoin::note(size_t source, const odo_scale& scale) {
  newest_[source] = scale;
  if (t_ns_ != INT64_MIN && (scale.scale_group != group_ || scale.valid_to_ns <= t_ns_)) return ScaleUse::late;
  return metric_ ? ScaleUse::pointless : ScaleUse::used;
}

void ScaleJoin::begin(const odo_vo_motion& motion, bool metric) {
  t_ns_ = motion.header.t_ns;
  metric_ = metric;
  group_ = motion.scale_group;
  found_.assign(newest_.size(), std::nullopt);
  for (size_t i = 0; i < newest_.size(); ++i)
    if (newest_[i] && holds(*newest_[i])) found_[i] = newest_[i];
}

ScaleUse ScaleJoin::answer(size_t source, const odo_scale& scale) {
  const ScaleUse later = note(source, scale);
  if (!holds(scale)) return later;
  found_[source] = scale;
  return metric_ ? ScaleUse::pointless : ScaleUse::used;
}

void ScaleJoin::reset() {
  newest_.assign(newest_.size(), std::nullopt);
  t_ns_ = INT64_MIN;
  metric_ = false;
}

const odo_scale* ScaleJoin::joined() {
  if (metric_) return nullptr;
  const odo_scale* first = nullptr;
  double weights = 0, weighted_logs = 0;
  int joined = 0;
  for (const auto& found : found_) {
    if (!found) continue;
    if (!first) first = &*found;
    // A horizontal scale and one of all three components measure different quantities.
    const bool alike = ((found->header.flags ^ first->header.flags) & ODO_SCALE_HORIZONTAL) == 0;
    if (!alike || !(found->scale > 0) || !(found->sigma > 0)) continue;
    const double relative = found->sigma / found->scale, weight = 1 / (relative * relative);
    weights += weight;
    weighted_logs += weight * std::log(found->scale);
    ++joined;
  }
  if (!first) return nullptr;
  joined_ = *first;
  if (joined < 2) return &joined_;
  joined_.scale = std::exp(weighted_logs / weights);
  joined_.sigma = joined_.scale / std::sqrt(weights);
  for (const auto& found : found_) {
    if (!found) continue;
    joined_.header.flags &= found->header.flags | ODO_SCALE_HORIZONTAL;
    joined_.valid_from_ns = std::max(joined_.valid_from_ns, found->valid_from_ns);
    joined_.valid_to_ns = std::min(joined_.valid_to_ns, found->valid_to_ns);
  }
  return &joined_;
}

}  // namespace odograph
