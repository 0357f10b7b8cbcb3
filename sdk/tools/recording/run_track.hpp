// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace odograph {

/// The track in the folder of a run: as known at its end where corrections came on the way, else as it came out.
inline std::filesystem::path track_of_run(const std::filesystem::path& folder) {
  std::error_code error;
  const auto corrected = folder / "corrected.tum";
  return std::filesystem::exists(corrected, error) ? corrected : folder / "trajectory.tum";
}

}  // namespace odograph
