// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/math/ring.hpp"

namespace odograph {

/// The newest N values in the order of their `t_ns`, found by time. No allocation. Not thread-safe.
template <class T, size_t N>
class TimedRing : public Ring<T, N> {
 public:
  /// A value of the newest's time replaces it; an older one is ignored.
  void push(const T& value) {
    if (this->empty() || value.t_ns > this->back(0).t_ns)
      Ring<T, N>::push(value);
    else if (value.t_ns == this->back(0).t_ns)
      this->back(0) = value;
  }
  /// How many of the newest values are later than a time: back() of it is the one at that time or before. size() if
  /// all are.
  size_t later_than(int64_t t_ns) const {
    size_t later = 0, most = this->size();
    while (later < most) {
      const size_t middle = (later + most) / 2;
      if (this->back(middle).t_ns > t_ns)
        later = middle + 1;
      else
        most = middle;
    }
    return later;
  }
};

/// Where a time lies between those of two values, 0 to 1.
template <class T>
double weight_between(const T& older, const T& newer, int64_t t_ns) {
  return static_cast<double>(t_ns - older.t_ns) / static_cast<double>(newer.t_ns - older.t_ns);
}

}  // namespace odograph
