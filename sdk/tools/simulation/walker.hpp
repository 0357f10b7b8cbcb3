// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/simulation/journey.hpp"
#include "sdk/tools/simulation/route.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// The walk of the individual whom the seed draws: body and hand with models of their own, shared with no estimator.
///
/// Step length follows speed as L ~ h v^0.42 (Grieve & Gear, Ergonomics 1966), times the individual's own factor
/// (+-10 %), left-right asymmetry, fatigue along the path and variation from step to step (stride time varies by 2 to 3
/// %: Hausdorff et al. 1996). The trunk rises and falls as an inverted pendulum would, flattened; sways with each
/// stride; the heel's shock rings through the body. The hand hangs on the trunk as a damped spring, trembles and
/// drifts.
Journey make_walk(const Scenario& scenario, const Route& route, uint64_t seed);
Journey make_walk(const Scenario& scenario, uint64_t seed);  ///< on the route as the scenario has it

}  // namespace odograph
