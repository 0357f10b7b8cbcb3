// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/coarse_clock.hpp"

#include <chrono>

namespace odograph {

int64_t coarse_now_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace odograph
