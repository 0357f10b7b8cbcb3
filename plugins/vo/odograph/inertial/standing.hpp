// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "plugins/vo/odograph/inertial/state.hpp"

namespace odograph::vio {

/// A tracked corner in a frame.
struct Corner {
  uint64_t track;
  Eigen::Vector2d pixel;  ///< of the calibrated lens, whatever lens took the frame
  double row = 0;         ///< of the frame, gives the time of exposure
};

struct FrameCorners {
  int64_t t_ns = 0;             ///< of the middle row, camera clock
  std::vector<Corner> corners;  ///< in ascending order of the track ids
};

/// Median residual flow between two frames after the best rotation, over their common corners, px. Nothing if there are
/// fewer than `least` of them, or if no rotation is found.
std::optional<double> residual_flow(const FrameCorners& before, const FrameCorners& now, const Camera& camera,
                                    size_t least);

}  // namespace odograph::vio
