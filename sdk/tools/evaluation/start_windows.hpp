// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <odograph/types.h>

#include "sdk/tools/recording/trajectory.hpp"

namespace odograph {

struct StartWindowParameters {
  std::vector<double> after_s{1, 2, 4};  ///< s of a scale group, at which its scale is compared; and at its end
  double min_extent_m = 0.15;            ///< rms distance of the true positions from their mean: less has no scale
  double certain_sigmas = 3;             ///< beyond it the scale was wrong and certain
  double largest_gap_s = 0.25;           ///< true poses further apart are not interpolated
};

/// What an odometry said of its scale and what it was, over the metric poses of one scale group up to a time.
struct ScaleClaim {
  double after_s;    ///< since the group's first metric motion
  double log_scale;  ///< of its path by the true one (similarity, Umeyama 1991)
  double sigma;      ///< stated with the last of these motions
  bool last;         ///< at the group's end
};

/// An odometry that is started somewhere in a recording.
struct StartWindow {
  double start_s;                  ///< from the first frame to the first metric motion; NaN: never
  size_t groups = 0;               ///< metric scale groups: more than one, and it has begun again
  std::vector<ScaleClaim> claims;  ///< of all groups
  double log_scale, sigma;         ///< of the longest group at its end; NaN: none
  double se3_rmse_m, sim3_rmse_m;  ///< of the same
  double path_m = 0;               ///< true, of the same
  double rotation_nees;            ///< mean over its frames, by degree of freedom; NaN: none
  double displacement_nees;        ///< the same, with the scale's sigma along the displacement
  double worst_sigmas;             ///< of the claims; NaN: none
};

/// `motions` of a run that began with the frame at `first_ns`. `truth` is the camera's, in order of time.
StartWindow start_window(const Trajectory& truth, const std::vector<odo_vo_motion>& motions, int64_t first_ns,
                         const StartWindowParameters& parameters = {});

}  // namespace odograph
