// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace odograph {

/// The newest N values of a stream; a new one takes the oldest one's place. No allocation.
template <class T, size_t N>
class Ring {
 public:
  void clear() { count_ = 0; }
  void push(const T& value) { values_[count_++ % N] = value; }
  bool empty() const { return count_ == 0; }
  size_t size() const { return std::min(count_, N); }
  /// So many values before the newest one, which is back(0); less than size().
  const T& back(size_t i) const { return values_[(count_ - 1 - i) % N]; }
  T& back(size_t i) { return values_[(count_ - 1 - i) % N]; }

 private:
  std::array<T, N> values_{};
  size_t count_ = 0;
};

}  // namespace odograph
