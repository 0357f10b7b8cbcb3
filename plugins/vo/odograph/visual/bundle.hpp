// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "plugins/vo/odograph/visual/window.hpp"

namespace odograph::vo {

struct BundleReport {
  bool solved = false;  ///< the window was adjusted
  bool failed = false;  ///< tried, but the window was left unchanged; neither: too few keyframes
  int observations = 0, iterations = 0;
};

/// Adjusts the keyframes of the window, the inverse depths of its triangulated points and the gyro bias together
/// (Ceres, Levenberg-Marquardt with a Schur complement, Cauchy loss). Gauge: until the first keyframe leaves the window
/// its pose and the length of the first baseline are fixed; afterwards the two oldest poses, so that the scale is
/// preserved. `sigma`: of an observation, normalized. Single-threaded, bit-identical when repeated. A failed adjustment
/// leaves window and bias unchanged and shows in the report only, as Ceres' log is silenced.
BundleReport adjust(Window& window, Eigen::Vector3d& bias_c, double sigma, const AdjustmentParameters& p = {});

}  // namespace odograph::vo
