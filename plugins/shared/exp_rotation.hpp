// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace odograph {

/// The rotation about a vector by its norm, rad.
inline Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& angle) {
  const double norm = angle.norm();
  if (norm < 1e-12) return {1.0, 0.5 * angle.x(), 0.5 * angle.y(), 0.5 * angle.z()};
  const Eigen::Vector3d axis = angle / norm * std::sin(0.5 * norm);
  return {std::cos(0.5 * norm), axis.x(), axis.y(), axis.z()};
}

}  // namespace odograph
