// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace odograph {

/// The track in a run's folder: with later corrections if there are any, otherwise as published.
inline std::filesystem::path track_of_run(const std::filesystem::path& folder) {
  std::error_code error;
  const auto corrected = folder / "corrected.tum";
  return std::filesystem::exists(corrected, error) ? corrected : folder / "trajectory.tum";
}

}  // namespace odograph
