// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace odograph {

/// The steady clock, ns, to within kCoarseClock_ns: a reading is a few ns instead of some 25, so that each call of a
/// plugin can have one before and one behind it. [any]
int64_t coarse_now_ns() noexcept;

/// The tick of a kernel of 100 Hz, the slowest there is.
inline constexpr int64_t kCoarseClock_ns = 10'000'000;

}  // namespace odograph
