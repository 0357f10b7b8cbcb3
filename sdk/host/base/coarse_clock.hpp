// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>

namespace odograph {

/// The steady clock, ns, to within kCoarseClock_ns: a reading is a few ns instead of some 25, so that each call of a
/// plugin can have one before and one behind it. [any]
inline int64_t coarse_now_ns() noexcept {
#if defined(CLOCK_MONOTONIC_COARSE)
  timespec now{};
  if (clock_gettime(CLOCK_MONOTONIC_COARSE, &now) == 0)
    return static_cast<int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
#endif
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

/// The tick of a kernel of 100 Hz, the slowest there is.
inline constexpr int64_t kCoarseClock_ns = 10'000'000;

}  // namespace odograph
