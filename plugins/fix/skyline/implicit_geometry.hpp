// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace odograph::skyline {

/// Corners of implicit geometries in a file: a few shapes may be placed any number of times.
inline constexpr size_t kMaxPlacedCorners = 20'000'000;

/// Transformation matrix of an implicit geometry, row by row.
using ImplicitMatrix = std::array<double, 16>;

/// Offset of a corner from the reference point.
inline Eigen::Vector3d transformed(const ImplicitMatrix& m, const Eigen::Vector3d& p) {
  return {m[0] * p.x() + m[1] * p.y() + m[2] * p.z() + m[3], m[4] * p.x() + m[5] * p.y() + m[6] * p.z() + m[7],
          m[8] * p.x() + m[9] * p.y() + m[10] * p.z() + m[11]};
}

}  // namespace odograph::skyline
