// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// A walk with typical behaviour: stops, looking around, evading, other carrying positions.
Scenario surveyor_walk(uint64_t seed);

/// A user who views the world through the phone: slow and gentle, with stops, turning in place, small steps, steps to
/// the side and backwards.
Scenario viewer_walk(uint64_t seed);

/// A walk with the phone against a thigh, in a bag and in a pocket.
Scenario pocket_walk(uint64_t seed);

/// Ten minutes in a car through a town, over bumps and with stops.
Scenario car_ride(uint64_t seed);

/// Ten minutes on the spot with the phone in the hand: `what` is "handle" (typing and gestures), "turn" or "lift".
Scenario standing(const std::string& what, bool viewer);

/// 200 m with a corner, and a GNSS position each second.
Scenario canyon_walk(double sigma_m);

}  // namespace odograph
