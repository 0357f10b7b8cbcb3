// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sdk/tools/simulation/motion.hpp"

namespace odograph {

/// A completed walk or drive: the phone's motion, and the truth about steps and marks.
struct Journey {
  Motion phone;  ///< of the body b (x right, y up, z out of the screen)
  struct Step {
    double t_start_s, t_end_s;  ///< from one foot's contact to the other's
    double length_m;
    uint32_t mode;  ///< ODO_MODE_*
  };
  std::vector<Step> steps;
  struct Mode {
    double t_start_s;
    uint32_t mode;
  };
  std::vector<Mode> modes;  ///< each valid until the next one
  struct Mark {
    double t_s;
    Eigen::Vector3d p_n;  ///< of the ground under the walker
  };
  std::vector<Mark> waypoints;
  struct Cover {
    double t_start_s, t_end_s;
  };
  std::vector<Cover> covers;  ///< times during which the phone is in a pocket

  /// Fraction of light that reaches the lens.
  double open_at(double t_s) const {
    constexpr double kSlip_s = 0.3, kDark = 1e-3;
    double open = 1;
    for (const Cover& c : covers) {
      const double inside = std::min(t_s - c.t_start_s, c.t_end_s - t_s) / kSlip_s;
      open = std::min(open, std::clamp(0.5 - inside, kDark, 1.0));
    }
    return open;
  }
};

}  // namespace odograph
