// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/step_length/step_scale.hpp"

#include <algorithm>

#include "sdk/math/time.hpp"

namespace odograph::step_scale {

void StepInterpolation::add_step(int64_t t_start_ns, int64_t t_end_ns, double length_m, double sigma_m) {
  const double duration = seconds(t_end_ns - t_start_ns);
  if (!(duration > 0 && length_m >= 0 && sigma_m >= 0)) return;
  steps_.push({t_end_ns, duration, length_m / duration, length_m > 0 ? sigma_m / length_m : 0.0});
  if (t_end_ns >= standing_since_ns_) standing_since_ns_ = INT64_MAX;
}

std::optional<Displacement> StepInterpolation::between(int64_t t0_ns, int64_t t1_ns) const {
  if (steps_.empty()) return std::nullopt;
  Displacement sum{0.0, 0.0};
  for (size_t i = steps_.size(); i-- > 0;) {  // oldest first
    const Step& step = steps_.back(i);
    int64_t until = step.t_end_ns + nanoseconds(hold_ * step.duration_s);
    if (i > 0) until = std::min(until, steps_.back(i - 1).t_end_ns);
    until = std::min(until, std::max(standing_since_ns_, step.t_end_ns));
    const int64_t from = std::max(t0_ns, step.t_end_ns), to = std::min(t1_ns, until);
    if (to <= from) continue;
    const double metres = step.speed_mps * static_cast<double>(to - from) * 1e-9;
    sum.relative_sigma += metres * step.relative_sigma;
    sum.metres += metres;
  }
  if (t1_ns <= steps_.back(steps_.size() - 1).t_end_ns) return std::nullopt;
  if (sum.metres > 0) sum.relative_sigma /= sum.metres;
  return sum;
}

}  // namespace odograph::step_scale
