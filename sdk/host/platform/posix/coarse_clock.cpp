// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/coarse_clock.hpp"

#include <chrono>
#include <ctime>

namespace odograph {

int64_t coarse_now_ns() noexcept {
#if defined(CLOCK_MONOTONIC_COARSE)
  timespec now{};
  if (clock_gettime(CLOCK_MONOTONIC_COARSE, &now) == 0)
    return static_cast<int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
#endif
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

}  // namespace odograph
