// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sdk/tools/recording/trajectory.hpp"

namespace odograph {

/// The track in a run's folder: with later corrections if there are any, otherwise as published.
inline std::filesystem::path track_of_run(const std::filesystem::path& folder) {
  std::error_code error;
  const auto corrected = folder / "corrected.tum";
  return std::filesystem::exists(corrected, error) ? corrected : folder / "trajectory.tum";
}

/// A file's poses: EuRoC's by its ending, KITTI's, whose twelve numbers a line would also be read as TUM's eight, or
/// TUM's.
inline Result<StampedPoses> read_poses(const std::filesystem::path& file,
                                       const std::filesystem::path& kitti_times = {}) {
  if (file.extension() == ".csv") return read_euroc_truth(file);
  auto kitti = read_kitti_poses(file, kitti_times);
  return kitti ? std::move(kitti) : read_tum(file);
}

}  // namespace odograph
