// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/calibration/camera_imu.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Corners tracked through all frames of a recording, its gyroscope, and its first calibration; row time from the first
/// frame. ODO_E_DATA without a calibration, or if its size is not the frames'. Missing frames or gyroscope are not a
/// failure.
Result<CameraImuData> camera_imu_data(const Recording& recording, const ProgressCallback& progress = {});

}  // namespace odograph
