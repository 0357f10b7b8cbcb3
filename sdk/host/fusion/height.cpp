// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/height.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/atmosphere.hpp"

namespace odograph {

bool LiftDetector::add(int64_t t_ns, double pressure_pa, Instant stepped) {
  if (!heights_.empty()) {
    const int64_t since = t_ns - heights_.back(0).t_ns;
    if (since < p_.min_interval_ns) return false;
    if (since > nanoseconds(p_.max_silence_s)) heights_.clear();
  }
  heights_.push({t_ns, pressure_height_m(pressure_pa)});
  const auto quick = slope(p_.lift_s, 0.7 * p_.lift_s, p_.min_samples),
             slow = slope(p_.escalator_s, 0.8 * p_.escalator_s, 2 * p_.min_samples);
  const auto stands = [&](int64_t from_ns) {
    return !stepped || (seconds(t_ns - *stepped) > p_.stands_s && from_ns >= *stepped - nanoseconds(p_.stands_s));
  };
  const auto rises = [&](const std::optional<Slope>& slope, double min_mps) {
    return slope && stands(slope->from_ns) &&
           std::abs(slope->mps) > std::max(min_mps, p_.clear_sigmas * slope->sigma_mps);
  };
  if (riding_) {
    if (!quick || std::abs(quick->mps) < p_.end_mps) stop(t_ns - nanoseconds(0.5 * p_.lift_s));
    return true;
  }
  const bool lift = rises(quick, p_.lift_mps);
  if (!lift && !rises(slow, p_.escalator_mps)) return true;
  riding_ = true;
  since_ = std::max(stepped, Instant((lift ? quick : slow)->from_ns));
  return true;
}

/// Line fit through the heights of the last `window_s`; nothing if they are fewer or span less than required.
std::optional<LiftDetector::Slope> LiftDetector::slope(double window_s, double min_span_s, size_t min_samples) const {
  if (heights_.empty()) return std::nullopt;
  double n = 0, t_sum = 0, h_sum = 0, tt = 0, th = 0, hh = 0, span_s = 0;
  const Sample newest = heights_.back(0);
  int64_t from_ns = newest.t_ns;
  for (size_t k = 0; k < heights_.size(); ++k) {
    const double t = seconds(heights_.back(k).t_ns - newest.t_ns), h = heights_.back(k).up_m - newest.up_m;
    if (t < -window_s) break;
    n += 1, t_sum += t, h_sum += h, tt += t * t, th += t * h, hh += h * h;
    span_s = -t, from_ns = heights_.back(k).t_ns;
  }
  if (n < static_cast<double>(min_samples) || span_s < min_span_s) return std::nullopt;
  tt -= t_sum * t_sum / n, th -= t_sum * h_sum / n, hh -= h_sum * h_sum / n;
  const double slope = th / tt, scatter = std::sqrt(std::max(0.0, hh - slope * th) / (n - 2));
  return Slope{slope, scatter * std::sqrt(12 / std::min(n, span_s / p_.gust_s)) / span_s, from_ns};
}

void Height::propagate(PoseFilter& filter, double dt_s) const {
  filter.add_variance(kBarometer, squared(p_.walk) * dt_s);
}

UpdateResult Height::use(PoseFilter& filter, const odo_barometer& barometer, double down_m, bool steps) {
  if (barometer.pressure_pa <= 0) return {};
  const double z_m = -pressure_height_m(barometer.pressure_pa);
  const int64_t t_ns = barometer.header.t_ns;
  if (!used_) {
    filter.set(kBarometer, z_m - down_m + filter.x()[kDown], squared(p_.sigma_m));
    filter.add_multiple(kBarometer, kDown, -1);
    used_ = t_ns;
    return {true, 0.0, 1};
  }
  // Gusts and doors last for seconds: the error of the readings within that time is correlated.
  const double since_s = std::clamp(seconds(t_ns - *used_), 0.01, p_.correlation_s);
  used_ = t_ns;
  Innovation height(1);
  height.residual[0] = z_m - down_m - filter.x()[kBarometer];
  height.H(0, kDown) = height.H(0, kBarometer) = 1;
  height.noise(0, 0) = squared(p_.sigma_m) * (steps ? 1.0 : p_.correlation_s / since_s);
  return filter.update(height, riding_ ? 0.0 : kGate[1], only({kLogScale, kLogFactor, kStepHeading, kHeading}));
}

void Height::ride(bool rides) {
  if (rides && !riding_) ride_until_ns_ = lift_.since().value_or(0);
  riding_ = rides;
}

bool Height::detect_ride(const odo_barometer& barometer, Instant stepped) {
  const bool was = riding_;
  if (lift_.add(barometer.header.t_ns, barometer.pressure_pa, stepped)) ride(lift_.riding());
  return riding_ != was;
}

void Height::add_ride_noise(PoseFilter& filter, int64_t t_ns) {
  const double dt_s = std::clamp(seconds(t_ns - ride_until_ns_), 0.0, p_.max_delay_s);
  ride_until_ns_ = std::max(t_ns, ride_until_ns_);
  filter.add_variance(kDown, squared(p_.lift_mps * dt_s));
}

}  // namespace odograph
