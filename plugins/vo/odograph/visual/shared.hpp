// SPDX-License-Identifier: Apache-2.0
//
// What the files of the odometry share.
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Geometry>

namespace odograph::vo {

inline constexpr int kLeastPoints = 12;
inline constexpr double kStartParallax_rad = 0.004;                 // median: less tells nothing of depth
inline constexpr double kPointParallax_rad = 0.002;                 // of a point whose depth shall count
inline constexpr double kLeastNoise_px = 0.3, kMostNoise_px = 1.2;  // of a corner
inline constexpr double kCoarse = 2.5, kCoarser = 1.3, kLearnNoise = 0.1;
inline constexpr double kDarkGrey = 8, kDimGrey = 60;

inline Eigen::Isometry3d isometry(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() = p;
  return T;
}

/// Of values in any order, which it changes; 0 of none.
inline double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace odograph::vo
