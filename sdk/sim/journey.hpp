// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sdk/sim/motion.hpp"

namespace odograph {

/// A walk or a drive that took place: how the phone moved, and the truth about feet and marks.
struct Journey {
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

}  // namespace odograph
