// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace odograph {

/// Fixed-size ring buffer of the newest N values. No allocation.
template <class T, size_t N>
class Ring {
 public:
  void clear() { count_ = 0; }
  void push(const T& value) { values_[count_++ % N] = value; }
  bool empty() const { return count_ == 0; }
  size_t size() const { return std::min(count_, N); }
  static constexpr size_t capacity() { return N; }
  /// The i-th newest value: back(0) is the newest. i < size().
  const T& back(size_t i) const { return values_[(count_ - 1 - i) % N]; }
  T& back(size_t i) { return values_[(count_ - 1 - i) % N]; }

 private:
  std::array<T, N> values_{};
  size_t count_ = 0;
};

}  // namespace odograph
