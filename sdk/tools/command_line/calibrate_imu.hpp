// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sdk/tools/calibration/calibrate_lens.hpp"

namespace odograph {

/// Writes a text file; ODO_E_IO on failure.
Result<bool> write_file(const std::filesystem::path& path, const std::string& text);

struct CalibrateImuArguments {
  std::string recording, camera, output;
  bool keep_lens = false, json = false;
};

/// `odograph calibrate --imu`: mount and time offset of a camera on its IMU, from a recording of both. `board`: a lens
/// from pictures of a board, or null. Returns the exit status.
int calibrate_imu(const CalibrateImuArguments& arguments, const LensCalibration* board);

}  // namespace odograph
