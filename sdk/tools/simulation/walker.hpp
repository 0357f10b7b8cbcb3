// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/simulation/journey.hpp"
#include "sdk/tools/simulation/route.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// The walk of the individual given by the seed, with models of body and hand that no estimator shares.
///
/// Step length follows speed as L ~ h v^0.42 (Grieve & Gear, Ergonomics 1966), with an individual factor (+-10 %),
/// left-right asymmetry, fatigue along the path and step-to-step variation (stride time varies by 2 to 3 %: Hausdorff
/// et al. 1996). The trunk moves vertically as a flattened inverted pendulum and sways with each stride; heel shocks
/// ring through the body. The hand is a damped spring on the trunk, with tremor and drift.
Journey make_walk(const Scenario& scenario, const Route& route, uint64_t seed);
Journey make_walk(const Scenario& scenario, uint64_t seed);  ///< on the scenario's route

}  // namespace odograph
