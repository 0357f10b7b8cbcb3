// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <odograph/types.h>

#include "sdk/tools/calibration/board.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {

/// A camera that takes pictures of a calibration board: lens, blur of a sixth of a pixel's neighbours, noise of two
/// grey levels, uneven light.
class BoardCamera {
 public:
  BoardCamera(const Board& board, const odo_calibration& lens);

  /// The board's pose in the camera: turned, tilted by up to 50 degrees, somewhere in the picture, from a third of it
  /// to a little more than all.
  Eigen::Isometry3d pose(uint64_t seed, uint64_t picture) const;
  cv::Mat picture(const Eigen::Isometry3d& T_c_board, uint64_t seed, uint64_t picture) const;

 private:
  bool is_whole(const Eigen::Isometry3d& T_c_board) const;
  Eigen::Isometry3d any_pose(Random& random) const;

  Board board_;
  odo_calibration lens_;
  cv::Mat print_;                  // the board in grey
  std::vector<cv::Point2d> rays_;  // at depth 1, of every sample: kSide x kSide of them a pixel
};

/// A phone's lens: no two seeds have the same, and the principal point is not in the middle.
odo_calibration random_lens(bool fisheye, uint64_t seed);

/// The board as it is found in pictures by a BoardCamera, those without it left out; the pictures are kept as PNG in a
/// folder if one is named. ODO_E_NOT_FOUND where that cannot be written.
Result<std::vector<BoardView>> simulated_views(const Board& board, const odo_calibration& lens, uint64_t seed,
                                               size_t pictures, const std::filesystem::path& folder,
                                               const std::function<void(size_t done, size_t all)>& progress);

}  // namespace odograph
