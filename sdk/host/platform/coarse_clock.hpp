// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace odograph {

/// Steady clock, ns, with a resolution of kCoarseClock_ns: a reading takes a few ns instead of about 25, which makes
/// timing every plugin call affordable. [any]
int64_t coarse_now_ns() noexcept;

/// Tick of a 100 Hz kernel, the slowest in use.
inline constexpr int64_t kCoarseClock_ns = 10'000'000;

}  // namespace odograph
