// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/gait/step_detector.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"

namespace odograph::gait {
namespace {

/// Time of the maximum of a parabola through three samples, of which the middle one is the largest.
int64_t top(int64_t t0, double y0, int64_t t1, double y1, int64_t t2, double y2) {
  const double a = static_cast<double>(t1 - t0), b = static_cast<double>(t2 - t1);
  if (a <= 0 || b <= 0) return t1;
  const double d0 = (y1 - y0) / a, d1 = (y2 - y1) / b;
  const double curvature = (d1 - d0) / (a + b);
  if (curvature >= 0) return t1;
  const double slope = (d0 * b + d1 * a) / (a + b);
  return t1 - static_cast<int64_t>(std::clamp(slope / (2 * curvature), -a, b));
}

}  // namespace

std::optional<DetectedStep> StepDetector::update(int64_t t_ns, double value, bool active) {
  std::optional<DetectedStep> found;
  if (!started_) {
    started_ = true;
  } else {
    const double threshold = std::max(p_.min_peak_mps2, p_.relative_peak * typical_peak_);
    const bool peak = last_value_ > previous_value_ && last_value_ >= value && last_value_ > threshold;
    if (peak && active && (!candidate_ || last_value_ > candidate_value_) &&
        last_ns_ - last_step_ns_ > nanoseconds(p_.min_interval_s)) {
      candidate_ = true;
      candidate_value_ = last_value_;
      candidate_ns_ = top(previous_ns_, previous_value_, last_ns_, last_value_, t_ns, value);
      lowest_before_candidate_ = lowest_;
    }
    if (candidate_ && t_ns - candidate_ns_ > nanoseconds(p_.confirm_s)) found = confirm();
    if (t_ns - last_step_ns_ > nanoseconds(2 * p_.max_interval_s)) typical_peak_ *= 0.99;
  }
  lowest_ = std::min(lowest_, value);
  absolute_sum_ += std::abs(value), sum_ += value, ++count_;
  previous_ns_ = last_ns_, previous_value_ = last_value_;
  last_ns_ = t_ns, last_value_ = value;
  return found;
}

std::optional<DetectedStep> StepDetector::confirm() {
  candidate_ = false;
  const bool fresh = candidate_ns_ - last_step_ns_ > nanoseconds(p_.max_interval_s);
  const DetectedStep step{fresh ? candidate_ns_ - nanoseconds(p_.start_interval_s) : last_step_ns_,
                          candidate_ns_,
                          candidate_value_ - lowest_before_candidate_,
                          absolute_sum_ / std::max(1, count_),
                          sum_ / std::max(1, count_),
                          candidate_value_};
  absolute_sum_ = sum_ = 0, count_ = 0;
  typical_peak_ = typical_peak_ == 0.0 ? candidate_value_ : typical_peak_ + 0.25 * (candidate_value_ - typical_peak_);
  last_step_ns_ = candidate_ns_;
  lowest_ = last_value_;
  return step;
}

}  // namespace odograph::gait
