// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "plugins/fix/skyline/match_parameters.hpp"
#include "plugins/fix/skyline/offset_map.hpp"

namespace odograph::skyline {

// Shared by the search and the uncertainty of a match.
inline constexpr double kDegree = MatcherParameters::kDegree;
inline bool by_cost(const Place& x, const Place& y) { return x.cost < y.cost; }
inline double apart(const Guess& x, const Guess& y) { return std::hypot(x.north - y.north, x.east - y.east); }

}  // namespace odograph::skyline
