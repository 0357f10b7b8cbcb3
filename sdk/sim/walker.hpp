// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sdk/sim/motion.hpp"
#include "sdk/sim/scenario.hpp"

namespace odograph {

/// A walk that took place: how the phone moved, and the truth about the feet.
struct Walk {
  Motion phone;  ///< of the body b (x right, y up, z out of the screen)
  struct Step {
    double t_start_s, t_end_s;  ///< one foot's contact to the other's
    double length_m;
    uint32_t mode;  ///< ODO_MODE_*
  };
  std::vector<Step> steps;
  struct Mode {
    double t_start_s;
    uint32_t mode;
  };
  std::vector<Mode> modes;  ///< each holds until the next begins
  struct Mark {
    double t_s;
    Eigen::Vector3d p_n;  ///< of the ground under the walker
  };
  std::vector<Mark> waypoints;
};

/// The walk of the individual whom the seed draws: body and hand with models of their own, shared with no estimator.
///
/// Step length follows speed as L ~ h v^0.42 (Grieve & Gear, Ergonomics 1966), times the individual's own factor
/// (+-10 %), left-right asymmetry, fatigue along the way and variation from step to step (stride time varies by 2 to 3
/// %: Hausdorff et al. 1996). The trunk rises and falls as an inverted pendulum would, flattened; sways with each
/// stride; the heel's shock rings through the body. The hand hangs on the trunk as a damped spring, trembles and
/// drifts.
Walk make_walk(const Scenario& scenario, uint64_t seed);

}  // namespace odograph
