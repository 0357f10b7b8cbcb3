// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

/// Excitation of a visual trajectory's scale by an accelerometer, against the trajectory's error.
///
/// In each window: S, the rms (over poses, of the 3-D distance) of the true positions about the best-fitting quadratic
/// in time, because constant velocity and constant acceleration carry no scale information with an uncertain
/// accelerometer bias; N, the same for the trajectory's errors after the Sim(3) alignment of that window (Umeyama
/// 1991), because that part of the error is indistinguishable from such motion. The errors-in-variables attenuation of
/// the scale is S^2 / (S^2 + N^2).
struct Excitation {
  double motion_m = 0;     ///< S, median over windows
  double error_m = 0;      ///< N, median over windows
  double attenuation = 1;  ///< of the medians
  size_t windows = 0;
};

struct ExcitationParameters {
  double window_s = 4;
  double overlap = 0.5;         ///< fraction shared by consecutive windows
  double min_speed_mps = 0.25;  ///< windows whose true path per window length is shorter are at rest and skipped
  double max_gap_s = 0.35;      ///< windows with longer gaps between poses are skipped
};

/// `pairs`: the true and the estimated pose at common times. Empty if no window remains.
Excitation excitation_of(const Pairs& pairs, const ExcitationParameters& parameters);

/// Rms distance of positions from the best-fitting quadratic in time of each axis; 0 for fewer than four.
double detrended_rms(const StampedPoses& trajectory);

}  // namespace odograph
