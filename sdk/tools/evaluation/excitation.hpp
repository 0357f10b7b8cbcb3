// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {

/// How much motion there is that can tell a visual trajectory's scale by an accelerometer, and how much error.
///
/// In each window: S, the rms (over poses, of the 3-D distance) of the true positions about the quadratic in time that
/// fits each axis best, since constant velocity and constant acceleration tell an uncertain accelerometer nothing; N,
/// the same of the trajectory's errors after the Sim(3) alignment of that window (Umeyama 1991), again about the best
/// quadratic, since that is the part of the error that can be taken for such motion. Errors in variables pull the scale
/// by S^2 / (S^2 + N^2).
struct Excitation {
  double motion_m = 0;  ///< S, median over windows
  double error_m = 0;   ///< N, median over windows
  double pull = 1;      ///< of the medians
  size_t windows = 0;
};

struct ExcitationParameters {
  double window_s = 4;
  double overlap = 0.5;  ///< part of a window that the next one shares
  double slowest_mps =
      0.25;  ///< windows in which the true path is shorter than this by the window are standing: left out
  double fullest_gap_s = 0.35;  ///< windows with longer gaps between poses are left out
};

/// `pairs`: the true and the estimated pose at common times. An empty result where no window is left.
Excitation excitation_of(const Pairs& pairs, const ExcitationParameters& parameters);

/// rms distance of positions from the quadratic in time that fits each axis best; 0 for fewer than four.
double detrended_rms(const Trajectory& trajectory);

}  // namespace odograph
