// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/floors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "sdk/math/scalar.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

namespace {

constexpr int64_t kMinSpacing_ns = 250'000'000;  // minimum spacing of the stored heights: 64 span 16 s

/// Cumulative normal distribution.
double normal_cdf(double sigmas) { return 0.5 * std::erfc(-std::sqrt(0.5) * sigmas); }

double normal_pdf(double off, double variance) { return std::exp(-0.5 * off * off / variance) / std::sqrt(variance); }

}  // namespace

FloorEstimator::FloorEstimator(const Parameters& parameters) : p_(parameters) {
  double sum = 0;
  for (size_t i = 0; i < buildings_.size(); ++i) {
    Building& building = buildings_[i];
    building.storey_m = p_.lowest_m + (p_.highest_m - p_.lowest_m) * double(i) / (buildings_.size() - 1);
    sum += building.weight = normal_pdf(building.storey_m - p_.storey_m, squared(p_.storey_sigma_m));
  }
  for (Building& building : buildings_) building.weight /= sum;
}

/// A visited floor lies at its measured height, any other at its number of storeys from the nearest visited one.
FloorEstimator::Likelihood FloorEstimator::likelihood(double up_m, const Building& building, int index,
                                                      int64_t t_ns) const {
  const int nearest = building.nearest[size_t(index)], storeys = std::abs(nearest - index);
  const Level& level = building.levels[size_t(nearest)];
  const double apart_m = up_m - level.up_m, off_m = apart_m - (index - nearest) * building.storey_m;
  const double measured =
      level.variance_m2 + squared(p_.drift_m) * std::max(0.0, seconds(t_ns - level.t_ns)) + squared(p_.floor_sigma_m);
  const double variance = measured + storeys * squared(p_.storey_scatter * building.storey_m);
  double on_it = (1 - p_.between) * normal_pdf(off_m, variance);
  if (storeys > 0)  // no storey is lower than lowest_m
    on_it *= normal_cdf(((index > nearest ? apart_m : -apart_m) - storeys * p_.lowest_m) / std::sqrt(measured));
  return {on_it, on_it + p_.between * normal_pdf(off_m, variance + squared(p_.between_storeys * building.storey_m))};
}

FloorEstimator::Floor FloorEstimator::nearest(int64_t t_ns, double up_m) const {
  std::array<double, kFloors> of_floor{};
  double all = 0;
  for (const Building& building : buildings_)
    for (int i = 0; i < kFloors; ++i) {
      // Prior uniform in height, not in floor number: low storeys are closer together.
      const double weight = building.weight * building.storey_m * likelihood(up_m, building, i, t_ns).either;
      of_floor[size_t(i)] += weight, all += weight;
    }
  const auto best = std::max_element(of_floor.begin(), of_floor.end());
  // Outside the modelled range, or on its outermost floor, which is nearest to everything beyond.
  const bool beyond = !(all > 0) || best == of_floor.begin() || best + 1 == of_floor.end();
  if (beyond) return {now_.floor, 0};
  return {static_cast<int32_t>(best - of_floor.begin()) + kLowest, *best / all};
}

/// Assigns the level to a floor of this building and updates that floor's height, unless the level is a landing.
/// Returns its relative likelihood.
double FloorEstimator::update_level(Building& building, int64_t t_ns, double up_m) const {
  double all = 0, best = 0;
  int index = 0;
  for (int i = 0; i < kFloors; ++i) {
    const Likelihood there = likelihood(up_m, building, i, t_ns);
    all += there.either;
    if (there.on_it > best) best = there.on_it, index = i;
  }
  if (!(best > 0.5 * all)) return building.storey_m * all;
  Level& level = building.levels[size_t(index)];
  const double sigma2 = squared(p_.floor_sigma_m);
  if (level.visited) {
    const double variance = level.variance_m2 + squared(p_.drift_m) * std::max(0.0, seconds(t_ns - level.t_ns));
    const double gain = variance / (variance + sigma2);
    level = {true, level.up_m + gain * (up_m - level.up_m), std::max((1 - gain) * variance, 0.01), t_ns};
  } else {
    level = {true, up_m, sigma2, t_ns};
    for (int i = 0; i < kFloors; ++i) {
      int& nearest = building.nearest[size_t(i)];
      if (std::abs(i - index) < std::abs(i - nearest)) nearest = index;
    }
  }
  return building.storey_m * all;
}

/// The walker has stayed on one level for a while. Staying longer adds no information about the building.
void FloorEstimator::update_level(int64_t t_ns, double up_m) {
  const bool other = std::abs(up_m - level_m_) > p_.other_m;
  level_m_ = up_m;
  std::array<double, kBuildings> weights;
  double sum = 0;
  for (size_t i = 0; i < kBuildings; ++i) {
    const double here = update_level(buildings_[i], t_ns, up_m);
    sum += weights[i] = buildings_[i].weight * (other ? here : 1.0);
  }
  if (!(sum > 0)) return;  // above the modelled range: no information about the buildings
  for (size_t i = 0; i < kBuildings; ++i) buildings_[i].weight = weights[i] / sum;
}

void FloorEstimator::add(int64_t t_ns, double up_m) {
  if (!begun_) {
    begun_ = true;
    level_m_ = up_m;
    for (Building& building : buildings_) {
      building.levels[-kLowest] = {true, up_m, squared(p_.floor_sigma_m), t_ns};
      building.nearest.fill(-kLowest);
    }
  } else if (t_ns - heights_.back(0).t_ns < kMinSpacing_ns) {
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
    update_level(t_ns, sum / static_cast<double>(n));
    heights_.clear();  // the next level starts a new set of heights
    heights_.push({t_ns, up_m});
  }
  now_ = nearest(t_ns, up_m);
}

std::optional<Notice> FloorEstimator::report() {
  if (now_.floor == reported_ || now_.probability < p_.reported) return std::nullopt;
  reported_ = now_.floor;
  std::snprintf(text_.data(), text_.size(), "floor %+d from where the track began, probability %.2f", now_.floor,
                now_.probability);
  return Notice{"floor", text_.data(), ODO_SEVERITY_INFO};
}

}  // namespace odograph
