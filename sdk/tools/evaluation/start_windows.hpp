// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <odograph/types.h>

#include "sdk/tools/recording/trajectory.hpp"

namespace odograph {

struct StartWindowParameters {
  std::vector<double> after_s{1, 2, 4};  ///< times within a scale group at which its scale is compared, besides its end
  /// Minimum rms distance of the true positions from their mean that determines a scale.
  double min_extent_m = 0.15;
  double confident_sigmas = 3;  ///< beyond it, the scale was confidently wrong
  double largest_gap_s = 0.25;  ///< true poses further apart are not interpolated
};

/// Stated and actual scale of an odometry, over the metric poses of one scale group up to a time.
struct StatedScale {
  double after_s;    ///< since the group's first metric motion
  double log_scale;  ///< of its path over the true one (similarity, Umeyama 1991)
  double sigma;      ///< stated with the last of these motions
  bool last;         ///< at the group's end
};

/// Results of an odometry started at some time of a recording.
struct StartWindow {
  double start_s;                   ///< from the first frame to the first metric motion; NaN: never
  size_t groups = 0;                ///< metric scale groups; more than one means a re-initialisation
  std::vector<StatedScale> scales;  ///< of all groups
  double log_scale, sigma;          ///< of the longest group at its end; NaN: none
  double se3_rmse_m, sim3_rmse_m;   ///< of the same
  double path_m = 0;                ///< true, of the same
  double rotation_nees;             ///< mean over its frames, per degree of freedom; NaN: none
  double displacement_nees;         ///< the same, including the scale's sigma along the displacement
  double worst_sigmas;              ///< maximum over the scales; NaN: none
};

/// `motions`: of a run that started with the frame at `first_ns`. `truth`: of the camera, in time order.
StartWindow start_window(const StampedPoses& truth, const std::vector<odo_vo_motion>& motions, int64_t first_ns,
                         const StartWindowParameters& parameters = {});

}  // namespace odograph
