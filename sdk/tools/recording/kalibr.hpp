// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Reads Kalibr's camchain-imucam.yaml or camchain.yaml: the first camera, cam0. Failures state file, line and column:
/// a missing key, a lens other than pinhole, a distortion other than radtan, equidistant or none.
Result<odo_calibration> read_camchain(const std::filesystem::path& file);

/// Formats camera.yaml (docs/recording.md), with full precision.
std::string camera_yaml(const odo_calibration& camera);

}  // namespace odograph
