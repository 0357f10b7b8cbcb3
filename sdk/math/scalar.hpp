// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace odograph {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kRad_per_deg = kPi / 180;
inline constexpr double kDeg_per_rad = 180 / kPi;

constexpr double squared(double x) { return x * x; }

}  // namespace odograph
