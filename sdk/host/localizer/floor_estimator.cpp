// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/floor_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "sdk/math/time.hpp"

namespace odograph {

namespace {

constexpr int64_t kApart_ns = 250'000'000;  // of two heights that are kept: 64 last for 16 s

double squared(double x) { return x * x; }

double gauss(double off, double variance) { return std::exp(-0.5 * off * off / variance) / std::sqrt(variance); }

}  // namespace

FloorEstimator::FloorEstimator(const Parameters& parameters) : p_(parameters) {
  double sum = 0;
  for (size_t i = 0; i < kStoreys; ++i)
    sum += weights_[i] = gauss(storey_m(i) - p_.storey_m, squared(p_.storey_sigma_m));
  for (double& weight : weights_) weight /= sum;
}

double FloorEstimator::storey_m(size_t hypothesis) const {
  return p_.lowest_m + (p_.highest_m - p_.lowest_m) * static_cast<double>(hypothesis) / (kStoreys - 1);
}

/// Where a floor is: as it was found, or by its storeys from the nearest one that was.
FloorEstimator::Expected FloorEstimator::expected(int floor, size_t hypothesis, int64_t t_ns) const {
  int nearest = 0, storeys = kFloors;
  for (int i = 0; i < kFloors; ++i) {
    const int apart = std::abs(i + kLowest - floor);
    if (levels_[static_cast<size_t>(i)].visited && apart < storeys) nearest = i, storeys = apart;
  }
  const Level& level = levels_[static_cast<size_t>(nearest)];
  const double storey = storey_m(hypothesis), steps = floor - (nearest + kLowest);
  const double drift = squared(p_.drift_m) * std::max(0.0, seconds(t_ns - level.t_ns));
  return {level.up_m + steps * storey, level.variance_m2 + drift + storeys * squared(p_.storey_scatter * storey)};
}

double FloorEstimator::likelihood(double up_m, int floor, size_t hypothesis, int64_t t_ns) const {
  const Expected there = expected(floor, hypothesis, t_ns);
  const double off_m = up_m - there.up_m, variance = there.variance_m2 + squared(p_.floor_sigma_m);
  return (1 - p_.between) * gauss(off_m, variance) +
         p_.between * gauss(off_m, variance + squared(p_.between_storeys * storey_m(hypothesis)));
}

FloorEstimator::Floor FloorEstimator::nearest(int64_t t_ns, double up_m) const {
  std::array<double, kFloors> of_floor{};
  double all = 0;
  for (size_t s = 0; s < kStoreys; ++s)
    for (int i = 0; i < kFloors; ++i) {
      // Low storeys lie closer together: each height is as likely, not each floor.
      const double weight = weights_[s] * storey_m(s) * likelihood(up_m, i + kLowest, s, t_ns);
      of_floor[static_cast<size_t>(i)] += weight, all += weight;
    }
  const auto best = std::max_element(of_floor.begin(), of_floor.end());
  if (!(all > 0)) return {now_.floor, 0};  // far from all floors that are told apart
  return {static_cast<int32_t>(best - of_floor.begin()) + kLowest, *best / all};
}

/// He has been on one level for a while: it is a floor's height, and tells of the storeys where it is new.
void FloorEstimator::see_level(int64_t t_ns, double up_m) {
  const Floor here = nearest(t_ns, up_m);
  if (here.probability < p_.known) return;
  Level& level = levels_[static_cast<size_t>(here.floor - kLowest)];
  if (!level.visited) {
    double sum = 0;
    for (size_t s = 0; s < kStoreys; ++s) {
      double any = 0;
      for (int i = 0; i < kFloors; ++i) any += likelihood(up_m, i + kLowest, s, t_ns);
      sum += weights_[s] *= storey_m(s) * any;
    }
    for (double& weight : weights_) weight /= sum;
    level = {true, up_m, squared(p_.floor_sigma_m), t_ns};
    return;
  }
  const double variance = level.variance_m2 + squared(p_.drift_m) * std::max(0.0, seconds(t_ns - level.t_ns));
  const double gain = variance / (variance + squared(p_.floor_sigma_m));
  level = {true, level.up_m + gain * (up_m - level.up_m), std::max((1 - gain) * variance, 0.01), t_ns};
}

void FloorEstimator::add(int64_t t_ns, double up_m) {
  if (!begun_) {
    begun_ = true;
    levels_[-kLowest] = {true, up_m, squared(p_.floor_sigma_m), t_ns};
  } else if (t_ns - heights_.back(0).t_ns < kApart_ns) {
    return;
  }
  heights_.push({t_ns, up_m});
  double sum = 0, highest = up_m, lowest = up_m, span_s = 0;
  size_t n = 0;
  for (; n < heights_.size() && span_s < p_.level_s; ++n) {
    const Height& height = heights_.back(n);
    span_s = seconds(t_ns - height.t_ns);
    sum += height.up_m, highest = std::max(highest, height.up_m), lowest = std::min(lowest, height.up_m);
  }
  if (span_s >= p_.level_s && highest - lowest < p_.level_m) {
    see_level(t_ns, sum / static_cast<double>(n));
    heights_.clear();  // the next level is of other heights
    heights_.push({t_ns, up_m});
  }
  now_ = nearest(t_ns, up_m);
}

}  // namespace odograph
