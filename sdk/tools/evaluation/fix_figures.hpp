// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Accuracy of absolute fixes, in time order, against a recording's truth.
struct FixFigures {
  std::vector<double> error_m;                 ///< horizontal, of each
  size_t beyond = 0;                           ///< fixes beyond three sigma of their own covariance
  size_t seconds = 0, with_fix = 0;            ///< with a skyline in view, and of those with a fix within half a second
  double first_after_m = -1, first_off_m = 0;  ///< true path until the first one, and its error; -1: no fix
};
FixFigures fix_figures(const Recording& recording, const std::vector<odo_fix>& fixes);

/// Angle between the verticals of each pose and the true pose at that time, deg.
std::vector<double> tilt_errors_deg(const StampedPoses& truth, const StampedPoses& track);

/// Results of a walk between houses: yaw error after 100 m of the true path (sampled every tenth of a second, so that
/// hand motion does not count), horizontal errors after settling, and the largest while the receiver was wrong or
/// shortly after.
struct CanyonFigures {
  double yaw_deg = 0, median_m = 0, largest_m = 0, in_reflection_m = 0;
};
struct CanyonParameters {
  double settled_s = 20, reflection_from_s = 60, reflection_to_s = 120, after_s = 5, yaw_after_m = 100;
};
CanyonFigures canyon_figures(const std::vector<TrueState>& truth, const StampedPoses& track,
                             const CanyonParameters& parameters = {});

}  // namespace odograph
