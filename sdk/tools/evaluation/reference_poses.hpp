// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Poses of a TUM file as poses of the recording's camera, in time order. `frame`: whose poses they are, "camera" or
/// "body" (the IMU). Fails as reading the file does; ODO_E_DATA for body poses of a recording without extrinsics;
/// ODO_E_ARGUMENT if the gyroscope shows that they belong to the other frame.
Result<StampedPoses> read_reference(const std::filesystem::path& tum, const std::string& frame,
                                    const Recording& recording);

}  // namespace odograph
