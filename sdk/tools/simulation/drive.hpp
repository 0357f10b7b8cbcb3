// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/simulation/journey.hpp"
#include "sdk/tools/simulation/route.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// A car along the route with the phone on its roof, the screen down and the rear camera up, the phone's top ahead.
///
/// Speed keeps to the limit, to 2 m/s^2 sideways in bends, and brakes for stops and bumps. The body dives, squats,
/// leans and heaves as a damped spring (1.2 to 1.6 Hz) over a road of ISO 8608 class A to B; wheels hop near 11 Hz; a
/// four-cylinder engine shakes it twice in each revolution of its shaft.
Journey make_drive(const Scenario& scenario, const Route& route, uint64_t seed);

}  // namespace odograph
