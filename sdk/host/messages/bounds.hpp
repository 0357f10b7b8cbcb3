// SPDX-License-Identifier: Apache-2.0
//
// Physically possible ranges of message fields, in SI units: one table for host, validator, recorder and fuzzers, all
// through message_fault(). The ranges are wide on purpose: plausibility is checked by the pipeline's gates.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "sdk/host/base/saturating.hpp"

namespace odograph::bounds {

struct Bounds {
  double low, high;
  const char* text;
  constexpr bool holds(double value) const { return value >= low && value <= high; }
};

/// Default for every field without a narrower bound; 1e9 m is far beyond any distance on the Earth.
inline constexpr Bounds kAnything = {-1e9, 1e9, "a number within +-1e9"};
inline bool are_numbers(const double* x, size_t n) {
  return std::all_of(x, x + n, [](double v) { return kAnything.holds(v); });
}
inline constexpr Bounds kLatitude_rad = {-1.5707963267948966, 1.5707963267948966, "-pi/2 to pi/2 (degrees?)"};
inline constexpr Bounds kLongitude_rad = {-6.283185307179587, 6.283185307179587, "-2 pi to 2 pi (degrees?)"};
/// Ellipsoidal: the deepest trench is 11 km deep; space begins at 100 km.
inline constexpr Bounds kHeight_m = {-12e3, 100e3, "-12 to 100 km"};
/// In n: half the Earth's circumference.
inline constexpr Bounds kPosition_m = {-2e7, 2e7, "within half the Earth's circumference, +-2e7 m"};
/// Pixels of a frame: a phone's whole sensor in binned readout has 12 million, a picture of 4K video 8. A picture of 48
/// million costs a front-end 2 GB and seconds.
inline constexpr uint64_t kMaxPixels = uint64_t(1) << 24;
/// Of any quantity: (3e7)^2, so that an unknown component can be stated.
inline constexpr double kMaxVariance = 1e15;
/// Smallest variance of a component that a fix states as known: (1 um)^2, below any sensor's accuracy and above the
/// filter's numerical limit.
inline constexpr double kMinKnownVariance = 1e-12;
/// Of an event relative to the newest message that its plugin received: the offset of two sensors' clocks.
inline constexpr int64_t kMaxAhead_ns = 1'000'000'000;
/// INT64_MIN: no message was received yet, and no time counts as ahead.
inline bool is_ahead(int64_t t_ns, int64_t newest_ns) {
  return newest_ns != INT64_MIN && saturating_difference(t_ns, newest_ns) > kMaxAhead_ns;
}

/// Whether a row-major matrix is a covariance up to rounding: symmetric and positive semidefinite (LDL' with pivots
/// relative to their variance).
inline bool is_covariance(const double* values, size_t rows) {
  constexpr double kRounding = 1e-6;
  double L[6][6] = {}, d[6] = {};
  const auto at = [&](size_t i, size_t k) { return values[i * rows + k]; };
  const auto scale = [&](size_t i, size_t k) { return std::sqrt(at(i, i)) * std::sqrt(at(k, k)); };
  for (size_t j = 0; j < rows; ++j) {
    d[j] = at(j, j);
    for (size_t k = 0; k < j; ++k) d[j] -= L[j][k] * L[j][k] * d[k];
    if (!(d[j] >= -kRounding * at(j, j))) return false;
    const bool determined = d[j] <= kRounding * kRounding * at(j, j);  // by the preceding components
    if (determined) d[j] = 0;
    for (size_t i = j + 1; i < rows; ++i) {
      if (!(std::abs(at(i, j) - at(j, i)) <= kRounding * scale(i, j) + 1e-300)) return false;
      double rest = at(i, j);
      for (size_t k = 0; k < j; ++k) rest -= L[i][k] * L[j][k] * d[k];
      if (!determined)
        L[i][j] = rest / d[j];
      else if (!(std::abs(rest) <= 1e-3 * scale(i, j) + 1e-300))
        return false;
    }
  }
  return true;
}

}  // namespace odograph::bounds
