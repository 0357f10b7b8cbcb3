// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <odograph/types.h>

#include "plugins/fix/skyline/photograph_matcher.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph::skyline {

/// The prior of a photograph from a pose and its covariance.
inline PhotographPrior photograph_prior(const odo_pose& pose, double height_sigma_m) {
  const auto sigma = [&](size_t a, size_t b) { return std::sqrt(std::max(pose.covariance[a], pose.covariance[b])); };
  return {.p_n = Eigen::Vector3d(pose.p_n),
          .q_n_c = raw_quaternion(pose.q_n).normalized(),
          .sigma_m = std::max(0.5, sigma(21, 28)),
          .height_sigma_m = height_sigma_m,
          .yaw_sigma_rad = std::clamp(sigma(14, 14), 0.02, std::numbers::pi),
          .tilt_sigma_rad = std::max(0.01, sigma(0, 7))};
}

}  // namespace odograph::skyline
