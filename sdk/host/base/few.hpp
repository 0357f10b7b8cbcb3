// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace odograph {

/// Up to N values in place, in order. A further one replaces the last.
template <class T, size_t N>
class Few {
 public:
  T& add(const T& value) {
    if (count_ < N) ++count_;
    return values_[count_ - 1] = value;
  }
  void clear() { count_ = 0; }
  size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  T& back() { return values_[count_ - 1]; }
  const T& operator[](size_t i) const { return values_[i]; }
  T* begin() { return values_.data(); }
  T* end() { return values_.data() + count_; }
  const T* begin() const { return values_.data(); }
  const T* end() const { return values_.data() + count_; }

 private:
  std::array<T, N> values_{};
  size_t count_ = 0;
};

}  // namespace odograph
