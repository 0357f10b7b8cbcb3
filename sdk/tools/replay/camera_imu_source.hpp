// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/calibration/camera_imu.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// The corners of a recording's frames, followed through all of them, its gyroscope, and what it says of the camera
/// (the first calibration). Row time as the first frame has it. ODO_E_DATA without a calibration or when its size is
/// not the frames'; without frames or gyroscope what there is.
Result<CameraImuData> camera_imu_data(const Recording& recording, const ProgressCallback& progress = {});

}  // namespace odograph
