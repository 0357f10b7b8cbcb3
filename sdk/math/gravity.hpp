// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Standard gravity, m/s^2 (CGPM 1901, resolution 3). It stands for the local gravity where that is unknown: on Earth
/// 9.780 at the equator to 9.832 at the poles, so the error is at most 0.03.
inline constexpr double kStandardGravity_mps2 = 9.80665;

/// Rounded gravity, for parameters that were fitted with it and inputs that are generated with it. The difference acts
/// as an accelerometer bias.
inline constexpr double kRoundedGravity_mps2 = 9.81;

}  // namespace odograph
