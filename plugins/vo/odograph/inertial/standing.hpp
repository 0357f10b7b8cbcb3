// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "plugins/vo/odograph/inertial/state.hpp"

namespace odograph::vio {

/// A followed corner in a frame.
struct Corner {
  uint64_t track;
  Eigen::Vector2d pixel;  ///< as the calibrated lens would have it, whatever lens the frame was taken with
  double row = 0;         ///< of the frame, for the time of its exposure
};

struct FrameCorners {
  int64_t t_ns = 0;             ///< of the middle row, camera's clock
  std::vector<Corner> corners;  ///< in ascending order of their tracks
};

/// What one rotation leaves over of the picture's flow between two frames, median over the corners that both have, px.
/// Nothing where these are fewer than `least`, or where no rotation is found.
std::optional<double> flow_beside_rotation(const FrameCorners& before, const FrameCorners& now, const Camera& camera,
                                           size_t least);

}  // namespace odograph::vio
