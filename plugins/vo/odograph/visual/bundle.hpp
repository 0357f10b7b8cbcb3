// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "plugins/vo/odograph/visual/window.hpp"

namespace odograph::vo {

struct BundleReport {
  bool solved = false;  ///< the window was adjusted
  bool failed = false;  ///< it was tried and left as it was; neither: too few keyframes
  int observations = 0, iterations = 0;
};

/// Adjusts the window's keyframes, the inverse depths of its located points and the gyroscope's bias together (Ceres,
/// Levenberg-Marquardt with a Schur complement, Cauchy loss). While no keyframe has been forgotten yet the first pose
/// and the first baseline's length are held; afterwards the two oldest poses, which earlier windows have settled: so
/// the scale stays what it was. `sigma`: of an observation, normalized. Single-threaded and repeatable bit for bit.
/// A failed adjustment leaves window and bias as they were, and says so in the report alone: Ceres' own log is silent.
BundleReport adjust(Window& window, Eigen::Vector3d& bias_c, double sigma, const AdjustmentParameters& p = {});

}  // namespace odograph::vo
