// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace odograph {

/// Saturating a - b: times come from outside and may have any value.
inline int64_t saturating_difference(int64_t a, int64_t b) {
  int64_t out;
  return __builtin_sub_overflow(a, b, &out) ? (a < b ? INT64_MIN : INT64_MAX) : out;
}

/// Saturating a + b.
inline int64_t saturating_sum(int64_t a, int64_t b) {
  int64_t out;
  return __builtin_add_overflow(a, b, &out) ? (b < 0 ? INT64_MIN : INT64_MAX) : out;
}

/// Seconds from one time to another.
inline double seconds(int64_t later_ns, int64_t earlier_ns) {
  return static_cast<double>(saturating_difference(later_ns, earlier_ns)) * 1e-9;
}

}  // namespace odograph
