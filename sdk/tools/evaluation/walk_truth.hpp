// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// A stretch of a walk whose true displacement is known.
struct TrueStretch {
  int64_t from_ns, to_ns;
  double length_m;
  double direction_rad;  ///< NaN where the truth is a distance alone
};

/// The steps and the track of a walk against whatever truth its recording has: true steps, a path, waypoints, a wheel's
/// distance, floors. NaN or empty where it has none.
struct WalkTruthFigures {
  double true_steps = 0, peaks = 0;      ///< peaks: what plain_peak_count() makes of it
  double count_percent = 0;              ///< of the steps, estimated less true
  double peaks_percent = 0;              ///< the same of the peaks
  double true_m = 0, estimated_m = 0;    ///< over the time that has a truth
  double position_m = 0;                 ///< rms, horizontal, the track laid on the truth by a rotation and a shift
  std::vector<double> heading_deg;       ///< of stretches of the track, after that
  std::vector<double> normalised_error;  ///< squared, of the steps' lengths over a stretch; they err alike
  /// Changes of floor between two places, and those that the track's height tells otherwise.
  double floors = 0, wrong_floors = 0;
  /// Places with a floor, of them those whose number, from the first one's, the localizer's estimator has of the
  /// track's heights, and the mean of its probabilities; NaN without floors.
  double floor_places = 0, floor_right = 0, floor_probability = 0;
  double counted = 0;  ///< steps of the time that has a truth, parts of them as parts
  /// Antigny et al. 2019, Table 5: the same steps and headings, once with their own lengths, once with a fixed one.
  /// Laid on the first place and rotated about it onto the others. NaN without places or headings.
  struct Composed {
    double end_m, mean_m;  ///< off at the last place, and in the mean
  } adaptive{}, fixed{};
};
/// Of everybody: the pedometers' rule of thumb for the height of 1.70 m that is taken where none is known.
constexpr double kFixedStep_m = 0.41 * 1.70;
WalkTruthFigures walk_truth_figures(const Recording& recording, const std::vector<odo_step>& steps,
                                    const Trajectory& track);

/// Peaks of the acceleration's norm, smoothed over 0.1 s, that stand 0.5 m/s^2 above its mean of a second and 0.3 s
/// apart: what nobody needs an SDK for.
size_t plain_peak_count(const Recording& recording);

/// Who walked and how the phone was carried, by the names that the data sets give their files. Where a set does not
/// say, the part of the name that may be one person.
struct WalkerName {
  std::string person, place;
};
WalkerName walker_name(const Recording& recording);

}  // namespace odograph
