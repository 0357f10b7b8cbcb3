// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// What a pipeline without a camera says of a walk.
struct WalkEstimate {
  const std::vector<odo_step>& steps;
  const std::vector<odo_motion_mode>& modes;  ///< each from its own time until the next one's
  const std::vector<odo_attitude>& attitudes;
};

/// The estimate against a simulated recording's true steps and states.
struct WalkFigures {
  double count_percent = 0, distance_percent = 0;  ///< estimated less true, of true; 0 where there is nothing true
  /// Of each step with a true one whose end is within 350 ms: times off, from its end until it is said, and the squared
  /// length error over its variance where it says one.
  std::vector<double> start_ms, end_ms, latency_ms, normalised_error;
  double mode_right_s = 0, mode_all_s = 0;
  std::map<std::pair<uint32_t, uint32_t>, double> modes_s;  ///< by true and estimated mode
  /// Inclination after the first 10 s, how fast the heading leaves the truth after half a minute, and how far it strays
  /// (95 % of the time) from north, or without a magnetometer from what it was then. Empty where it is too short.
  std::vector<double> tilt_deg, drift_deg_min, wander_deg;
};
WalkFigures walk_figures(const Recording& recording, const WalkEstimate& estimate);

/// How fast the heading leaves the phone's own, deg/min: the median of the last tenth less that of the first, by the
/// time between. NaN where there are fewer than a hundred attitudes beside the phone's.
double heading_drift(const std::vector<odo_attitude>& attitudes, const std::vector<StampedPose>& own);

/// Of the recording's marks and the truth's end the one at which its true steps come nearest to a distance walked.
struct WalkedPlace {
  int64_t t_ns;
  double walked_m;
};
WalkedPlace place_walked_to(const Recording& recording, double walked_m);

/// How far off a track is horizontally: the mean over the truth, and at each of the places, also by the distance
/// walked.
struct PlaceErrors {
  double mean_m = 0;
  std::vector<double> error_m, error_percent;
};
PlaceErrors place_errors(const Trajectory& truth, const Trajectory& track, const std::vector<WalkedPlace>& places);

}  // namespace odograph
