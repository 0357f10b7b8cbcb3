// SPDX-License-Identifier: Apache-2.0
//
// What numbers of messages can mean at all, in SI units: one table for host, validator, recorder and fuzzers, which all
// ask message_fault(). It is wide on purpose: what a pipeline makes of a possible value is its gates' matter.
#pragma once

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

/// Every number of every message that has no narrower bound: the Sun is 1.5e11 m away, and nobody walks there.
inline constexpr Bounds kAnything = {-1e9, 1e9, "a number within +-1e9"};
inline constexpr Bounds kLatitude_rad = {-1.5707963267948966, 1.5707963267948966, "-pi/2 to pi/2 (degrees?)"};
inline constexpr Bounds kLongitude_rad = {-6.283185307179587, 6.283185307179587, "-2 pi to 2 pi (degrees?)"};
/// Ellipsoidal: the deepest trench is 11 km deep; 100 km is where spacecraft begin.
inline constexpr Bounds kHeight_m = {-12e3, 100e3, "-12 to 100 km"};
/// In n: half the Earth's circumference.
inline constexpr Bounds kPlace_m = {-2e7, 2e7, "within half the Earth's circumference, +-2e7 m"};
/// Of a frame: the whole sensor of a phone read at once has 12 million, a picture of 4K video 8. One of 48 takes a
/// front-end 2 GB and seconds.
inline constexpr uint64_t kMaxPixels = uint64_t(1) << 24;
/// Of any quantity: (3e7)^2, so that "nowhere near known" can be stated.
inline constexpr double kMaxVariance = 1e15;
/// Of what a fix states to know: (1 um)^2, below what any sensor measures and above where the filter's numbers end.
inline constexpr double kMinKnownVariance = 1e-12;
/// Of an event after the newest message that its plugin has been given: clocks of two sensors may differ by that.
inline constexpr int64_t kMaxAhead_ns = 1'000'000'000;
/// INT64_MIN: nothing has been given yet, and no time is ahead of it.
inline bool is_ahead(int64_t t_ns, int64_t newest_ns) {
  return newest_ns != INT64_MIN && saturating_difference(t_ns, newest_ns) > kMaxAhead_ns;
}

/// Whether a matrix, row by row, is a covariance up to rounding: symmetric, and positive semidefinite (LDL' with
/// pivots relative to their variance).
inline bool is_covariance(const double* values, size_t rows) {
  constexpr double kRounding = 1e-6;
  double L[6][6] = {}, d[6] = {};
  const auto at = [&](size_t i, size_t k) { return values[i * rows + k]; };
  const auto scale = [&](size_t i, size_t k) { return std::sqrt(at(i, i)) * std::sqrt(at(k, k)); };
  for (size_t j = 0; j < rows; ++j) {
    d[j] = at(j, j);
    for (size_t k = 0; k < j; ++k) d[j] -= L[j][k] * L[j][k] * d[k];
    if (!(d[j] >= -kRounding * at(j, j))) return false;
    const bool determined = d[j] <= kRounding * kRounding * at(j, j);  // by those before it
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
