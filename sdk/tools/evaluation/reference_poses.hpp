// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// A TUM file's poses as those of the recording's camera, in order of time. `frame`: whose poses they are, "camera" or
/// "body" (the IMU). Failures: the file's own; ODO_E_DATA where body poses meet a recording without extrinsics;
/// ODO_E_ARGUMENT where the gyroscope says that they are the other frame's.
Result<Trajectory> read_reference(const std::filesystem::path& tum, const std::string& frame,
                                  const Recording& recording);

}  // namespace odograph
