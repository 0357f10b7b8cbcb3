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

/// A camera that takes pictures of a calibration board, with lens, Gaussian blur of 0.6 px, noise of two grey levels
/// and uneven light.
class BoardCamera {
 public:
  BoardCamera(const Board& board, const odo_calibration& lens);

  /// Pose of the board in the camera: rotated, tilted by up to 50 degrees, anywhere in the picture, covering a third of
  /// it to slightly more than all.
  Eigen::Isometry3d pose(uint64_t seed, uint64_t picture) const;
  cv::Mat picture(const Eigen::Isometry3d& T_c_board, uint64_t seed, uint64_t picture) const;

 private:
  bool is_whole(const Eigen::Isometry3d& T_c_board) const;
  Eigen::Isometry3d any_pose(Random& random) const;

  Board board_;
  odo_calibration lens_;
  cv::Mat print_;                  // the board in grey
  std::vector<cv::Point2d> rays_;  // at depth 1, for each sample: kSide x kSide per pixel
};

/// A phone lens, different for each seed, with an off-centre principal point.
odo_calibration random_lens(bool fisheye, uint64_t seed);

/// Board detections in pictures by a BoardCamera, without failed ones; saves the pictures as PNG to a folder if given.
/// ODO_E_IO if that fails.
Result<std::vector<BoardView>> simulated_views(const Board& board, const odo_calibration& lens, uint64_t seed,
                                               size_t pictures, const std::filesystem::path& folder,
                                               const std::function<void(size_t done, size_t all)>& progress);

}  // namespace odograph
