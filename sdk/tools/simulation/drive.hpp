// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/simulation/journey.hpp"
#include "sdk/tools/simulation/route.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// A car on the route with the phone on its roof: screen down, rear camera up, top forward.
///
/// Speed obeys the limit and 2 m/s^2 lateral acceleration in bends, and decreases for stops and bumps. The body
/// pitches, rolls and heaves as a damped spring (1.2 to 1.6 Hz) over a road of ISO 8608 class A to B; wheels hop near
/// 11 Hz; a four-cylinder engine shakes the body twice per crankshaft revolution.
Journey make_drive(const Scenario& scenario, const Route& route, uint64_t seed);

}  // namespace odograph
