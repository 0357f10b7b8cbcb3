// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace odograph {

/// Troposphere of the International Standard Atmosphere (ISO 2533): 101325 Pa and 288.15 K at sea level, lapse rate 6.5
/// K/km. The exponent is R L / (M g).
inline constexpr double kSeaLevel_pa = 101325, kTemperatureHeight_m = 288.15 / 0.0065, kPressureExponent = 0.190263;

/// Pressure altitude, m, positive above sea level. The pressure must be positive.
inline double pressure_height_m(double pressure_pa) {
  return kTemperatureHeight_m * (1 - std::pow(pressure_pa / kSeaLevel_pa, kPressureExponent));
}

/// Pressure, Pa, at a pressure altitude below 44 km; inverse of pressure_height_m().
inline double pressure_at_pa(double height_m) {
  return kSeaLevel_pa * std::pow(1 - height_m / kTemperatureHeight_m, 1 / kPressureExponent);
}

}  // namespace odograph
