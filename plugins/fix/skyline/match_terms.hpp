// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "plugins/fix/skyline/offset_map.hpp"

namespace odograph::skyline {

// What the search for a place and the doubt about it share.
inline constexpr double kDegree = std::numbers::pi / 180;
inline constexpr double kNoise_rad = 0.25 * kDegree;  // least mean loss believed
inline constexpr double kSoft_rad =
    0.6 * kDegree;                                // from here on a direction pulls less and less (Geman & McClure 1987)
inline constexpr double kMost_rad = 3 * kDegree;  // a direction's largest loss
inline constexpr double kCorrelated = 12;         // neighbouring directions err together: six degrees
inline constexpr double kSpread_m = 2.5;          // between them

inline bool by_cost(const Place& x, const Place& y) { return x.cost < y.cost; }
inline double apart(const Guess& x, const Guess& y) { return std::hypot(x.north - y.north, x.east - y.east); }

}  // namespace odograph::skyline
