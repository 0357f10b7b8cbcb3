// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Standard gravity, m/s^2 (CGPM 1901, resolution 3): what an accelerometer at rest measures unless something better is
/// known. On Earth it is 9.780 at the equator to 9.832 at the poles, so 0.03 off at most.
inline constexpr double kStandardGravity_mps2 = 9.80665;

/// Where parameters were fitted, or inputs are made, with a rounded gravity; the difference is bias.
inline constexpr double kRoundedGravity_mps2 = 9.81;

}  // namespace odograph
