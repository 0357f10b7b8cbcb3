// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Output of a pipeline without a camera on a walk.
struct WalkEstimate {
  const std::vector<odo_step>& steps;
  const std::vector<odo_motion_mode>& modes;  ///< each valid until the next one
  const std::vector<odo_attitude>& attitudes;
};

/// The estimate compared with a simulated recording's true steps and states.
struct WalkFigures {
  double count_percent = 0, distance_percent = 0;  ///< estimated minus true, relative to true; 0 without truth
  /// For each step with a true one whose end is within 350 ms: time errors, latency from its end to its report, and
  /// squared length error over its stated variance.
  std::vector<double> start_ms, end_ms, latency_ms, normalised_error;
  double mode_right_s = 0, mode_all_s = 0;
  /// Inclination after the first 10 s, heading drift after half a minute, and heading error (95 % of the time) against
  /// north or, without a magnetometer, against its value at that time. Empty if the walk is too short.
  std::vector<double> tilt_deg, drift_deg_min, heading_error_deg;
};
WalkFigures walk_figures(const Recording& recording, const WalkEstimate& estimate);

/// Heading drift against the phone's own, deg/min: the median of the last tenth minus that of the first, over the time
/// between. NaN for fewer than a hundred attitudes beside the phone's.
double heading_drift(const std::vector<odo_attitude>& attitudes, const std::vector<StampedPose>& own);

/// The recording's mark, or the truth's end, whose true path is nearest to a distance walked.
struct WalkedPlace {
  int64_t t_ns;
  double walked_m;
};
WalkedPlace place_walked_to(const Recording& recording, double walked_m);

/// Times of the fixes of position and orientation, as known objects give them, in order.
std::vector<int64_t> object_fixes(const std::vector<odo_fix>& fixes);
/// The place just before the known object near it was used: Antigny et al. 2019, Table 5, has the errors "before a
/// known object-based reinitialization". The place itself without one in the 20 s before it.
WalkedPlace before_objects(WalkedPlace place, const std::vector<int64_t>& object_fixes_ns);
/// The first track until a time, then the second.
StampedPoses joined(const StampedPoses& first, const StampedPoses& second, int64_t from_ns);

/// Horizontal errors of a track: the mean over the truth, and at each place, also relative to the distance walked.
struct PlaceErrors {
  double mean_m = 0;
  std::vector<double> error_m, error_percent;
};
PlaceErrors place_errors(const StampedPoses& truth, const StampedPoses& track, const std::vector<WalkedPlace>& places);

}  // namespace odograph
