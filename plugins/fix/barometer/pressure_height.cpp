// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/barometer/pressure_height.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/atmosphere.hpp"
#include "sdk/math/time.hpp"

namespace odograph::barometer {
namespace {

constexpr double kMin_pa = 30'000, kMax_pa = 120'000;

}  // namespace

double PressureHeight::down_of(double pressure_pa) { return -pressure_height_m(pressure_pa); }

/// Variance of an average: the number of independent readings is its length over twice the correlation time of gusts,
/// at least one.
double PressureHeight::noise_variance() const {
  return p_.noise_m * p_.noise_m / std::max(1.0, p_.average_s / (2 * p_.noise_correlation_s));
}

void PressureHeight::refer(int64_t t_ns, double down_m, double variance_m2) {
  waiting_ = Reference{t_ns, down_m, variance_m2, 0};
  if (!last_by_pressure_m_ || std::abs(seconds(t_ns - last_ns_)) > p_.average_s) return;
  waiting_->by_pressure_m = *last_by_pressure_m_;
  reference_ = waiting_;
  waiting_.reset();
}

std::optional<PressureHeight::Height> PressureHeight::add(int64_t t_ns, double pressure_pa) {
  if (!(pressure_pa >= kMin_pa && pressure_pa <= kMax_pa)) return {};
  if (mean_.n > 0 && (t_ns < mean_.t_ns || seconds(t_ns - mean_.t_ns) > p_.longest_gap_s)) mean_ = {};
  if (mean_.n == 0) mean_.first_ns = t_ns;
  mean_.t_ns = t_ns;
  mean_.t_s += seconds(t_ns - mean_.first_ns), mean_.down_m += down_of(pressure_pa), ++mean_.n;
  if (seconds(t_ns - mean_.first_ns) < p_.average_s * (1 - 1e-6)) return {};
  const double by_pressure_m = mean_.down_m / mean_.n;
  const int64_t middle_ns = mean_.first_ns + nanoseconds(mean_.t_s / mean_.n);
  mean_ = {};
  last_by_pressure_m_ = by_pressure_m, last_ns_ = middle_ns;
  if (waiting_) {
    reference_ = waiting_;
    reference_->by_pressure_m = by_pressure_m;
    waiting_.reset();
    return {};  // the reference itself
  }
  if (!reference_) return {};
  const double since_s = std::abs(seconds(middle_ns - reference_->t_ns));
  const double trend_m = p_.trend_mps * since_s;
  const double common =
      reference_->variance_m2 + noise_variance() + p_.walk_m * p_.walk_m * since_s + trend_m * trend_m;
  const auto alike = [&](double correlation_s) { return std::max(1.0, 2 * correlation_s / p_.average_s); };
  return Height{middle_ns, reference_->down_m + by_pressure_m - reference_->by_pressure_m, common + noise_variance(),
                alike(p_.alike_s) * common + alike(p_.noise_correlation_s) * noise_variance()};
}

}  // namespace odograph::barometer
