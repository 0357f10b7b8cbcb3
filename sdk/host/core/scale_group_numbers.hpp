// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace odograph {

/// Numbers the scale groups of all front-ends in use. A front-end counts its groups anew after a reset, and so does
/// another that takes over: their groups get numbers beyond all earlier ones. Those of the first remain as they are.
class ScaleGroupNumbers {
 public:
  /// `instance`: number of the front-end, `resets`: how often it has been reset, `group`: its own number.
  uint32_t number(uint32_t instance, uint32_t resets, uint32_t group) {
    const std::pair counter{instance, resets};
    if (counter_ && *counter_ != counter) offset_ = next_;
    counter_ = counter;
    const uint32_t number = group + offset_;
    next_ = std::max(next_, number + 1);
    return number;
  }

 private:
  std::optional<std::pair<uint32_t, uint32_t>> counter_;
  uint32_t offset_ = 0, next_ = 0;
};

}  // namespace odograph
