// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace odograph {

inline constexpr int64_t kMillisecond_ns = 1'000'000;
inline constexpr int64_t kSecond_ns = 1'000'000'000;

/// A time of the sensor clock, ns, or never: nothing, which precedes every time.
using Instant = std::optional<int64_t>;

constexpr double seconds(int64_t ns) { return static_cast<double>(ns) * 1e-9; }
/// Rounds to the nearest nanosecond; |s| must be below 9.2e9.
inline int64_t nanoseconds(double s) { return std::llround(s * 1e9); }

}  // namespace odograph
