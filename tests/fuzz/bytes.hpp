// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>

namespace fuzz {

/// Consumes numbers and strings of bytes from an input; beyond its end they are zero and empty.
class Bytes {
 public:
  Bytes(const uint8_t* data, size_t size) : left_(data, size) {}
  bool empty() const { return left_.empty(); }
  template <class T>
  T take() {
    T value{};
    const auto part = take(sizeof value);
    std::memcpy(&value, part.data(), part.size());
    return value;
  }
  std::span<const uint8_t> take(size_t size) {
    const auto part = left_.first(std::min(size, left_.size()));
    left_ = left_.subspan(part.size());
    return part;
  }
  /// Up to the next byte with this value, which is skipped.
  std::span<const uint8_t> take_until(uint8_t end) {
    const auto found = std::find(left_.begin(), left_.end(), end);
    const auto part = left_.first(static_cast<size_t>(found - left_.begin()));
    left_ = left_.subspan(std::min(part.size() + 1, left_.size()));
    return part;
  }
  std::span<const uint8_t> rest() { return take(left_.size()); }

 private:
  std::span<const uint8_t> left_;
};

}  // namespace fuzz
