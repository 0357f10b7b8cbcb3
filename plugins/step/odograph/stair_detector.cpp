// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/stair_detector.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"

namespace odograph::steps {

void StairDetector::add(int64_t t_ns, double pressure_pa) {
  if (!heights_.empty()) {
    const int64_t since = t_ns - heights_.back(0).t_ns;
    if (since < p_.min_interval_ns) return;
    if (since > nanoseconds(p_.window_s)) reset();
  }
  heights_.push({t_ns, -p_.metres_per_pascal * pressure_pa});
  double n = 0, t_sum = 0, h_sum = 0, tt = 0, th = 0, hh = 0;
  const double first_m = heights_.back(0).m;
  double span_s = 0;
  for (size_t k = 0; k < heights_.size(); ++k) {
    const Height& height = heights_.back(k);
    const double t = seconds(height.t_ns - t_ns), h = height.m - first_m;
    if (t < -p_.window_s) break;
    n += 1, t_sum += t, h_sum += h, tt += t * t, th += t * h, hh += h * h;
    span_s = -t;
  }
  if (n < static_cast<double>(p_.min_samples) || span_s < p_.min_span_s) return;
  tt -= t_sum * t_sum / n, th -= t_sum * h_sum / n, hh -= h_sum * h_sum / n;
  const double slope = th / tt, scatter = std::sqrt(std::max(0.0, hh - slope * th) / (n - 2));
  const double sigma = scatter * std::sqrt(12 / std::min(n, span_s / p_.gust_s)) / span_s;
  climb_mps_ = slope;
  const bool ascended = ascends_;
  ascends_ =
      ascends_ ? std::abs(slope) > p_.end_mps : std::abs(slope) > std::max(p_.begin_mps, p_.clear_sigmas * sigma);
  // A change that the slope did not cause is due to the last steps.
  const int64_t middle_ns = t_ns - static_cast<int64_t>(0.5e9 * span_s);
  update_state(ascends_ != ascended ? middle_ns : std::max(middle_ns, step_ns_));
}

void StairDetector::add_step(int64_t t_start_ns, int64_t t_end_ns, double length_m) {
  if (t_end_ns <= t_start_ns) return;
  // A barometer without new samples gives no climb.
  if (!heights_.empty() && t_end_ns - heights_.back(0).t_ns > nanoseconds(p_.window_s)) reset();
  const double speed_mps = length_m * 1e9 / static_cast<double>(t_end_ns - t_start_ns);
  const bool begins = t_start_ns - step_ns_ > nanoseconds(p_.pause_s);
  speed_mps_ = begins ? speed_mps : speed_mps_ + p_.learn_speed * (speed_mps - speed_mps_);
  step_ns_ = t_end_ns;
  update_state(t_start_ns);
}

void StairDetector::update_state(int64_t since_ns) {
  const double steepest = on_stairs_ ? p_.still_steep : p_.steepest_ramp;
  const bool on_stairs = ascends_ && std::abs(climb_mps_) > steepest * speed_mps_;
  if (on_stairs == on_stairs_) return;
  on_stairs_ = on_stairs;
  since_ns_ = since_ns;
}

}  // namespace odograph::steps
