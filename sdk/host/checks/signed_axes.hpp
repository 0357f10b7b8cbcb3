// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include <Eigen/Core>

namespace odograph {

/// An exchange of axes with signs, one of 48: a rotation, or mirrored.
struct SignedAxes {
  std::array<int8_t, 3> from{0, 1, 2};  ///< axis i of the result is axis from[i] of the input, times sign[i]
  std::array<int8_t, 3> sign{1, 1, 1};

  double of(const Eigen::Vector3d& v, size_t i) const { return sign[i] * v[from[i]]; }
  /// Number of axes that it changes.
  int changes() const {
    int count = 0;
    for (size_t i = 0; i < 3; ++i) count += from[i] != static_cast<int8_t>(i) || sign[i] < 0;
    return count;
  }
  /// Of a rotation rate of the opposite sign: what exchanges it as these exchange a force.
  SignedAxes of_opposite_rate() const;
  /// Such as "(-y, x, z)".
  std::string text() const;
};

/// All of them, those with fewer changes first: the identity is the first.
const std::array<SignedAxes, 48>& all_signed_axes();

}  // namespace odograph
