// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// A part of a walk whose true displacement is known.
struct TrueStretch {
  int64_t from_ns, to_ns;
  double length_m;
  double direction_rad;  ///< NaN if the truth is only a distance
};

/// Steps and track of a walk compared with the available truth: true steps, a path, waypoints, a wheel's distance,
/// floors. NaN or empty where it is missing.
struct WalkTruthFigures {
  double true_steps = 0, peaks = 0;      ///< peaks: count of plain_peak_count()
  double count_percent = 0;              ///< of the steps, estimated minus true
  double peaks_percent = 0;              ///< the same for the peaks
  double true_m = 0, estimated_m = 0;    ///< over the time with truth
  int64_t from_ns = 0, to_ns = 0;        ///< that time
  double position_m = 0;                 ///< rms, horizontal, after yaw alignment
  std::vector<double> heading_deg;       ///< of stretches of the track, after that alignment
  std::vector<double> normalised_error;  ///< squared, of the steps' lengths over a stretch, whose errors are correlated
  /// Changes of floor between two places, and those for which the track's height gives another number.
  double floors = 0, wrong_floors = 0;
  /// Places with a known floor; of them, those whose number relative to the first the floor estimator finds from the
  /// track's heights, and the mean of its probabilities; NaN without floors.
  double floor_places = 0, floor_right = 0, floor_probability = 0;
  double counted = 0;                ///< steps within the time with truth, fractions included
  double walked_s = 0, sigma_m = 0;  ///< their duration, and the sum of their standard deviations
  /// Antigny et al. 2019, Table 5: the same steps and headings with their own lengths and with a fixed one. Aligned at
  /// the first place and rotated about it onto the others. NaN without places or headings.
  struct Composed {
    double end_m, mean_m;  ///< error at the last place, and mean error
  } adaptive{}, fixed{};
};
/// For everybody: the pedometers' rule of thumb at the default height of 1.70 m.
constexpr double kFixedStep_m = 0.41 * 1.70;
WalkTruthFigures walk_truth_figures(const Recording& recording, const std::vector<odo_step>& steps,
                                    const StampedPoses& track);

/// Baseline step count: peaks of the acceleration's norm, smoothed over 0.1 s, that exceed its mean over a second by
/// 0.5 m/s^2 and are 0.3 s apart.
size_t plain_peak_count(const Recording& recording);

/// Walker and carrying position from the data sets' file names. If a set does not state the walker, the part of the
/// name that may identify one.
struct WalkerName {
  std::string person, place;
};
WalkerName walker_name(const Recording& recording);

}  // namespace odograph
