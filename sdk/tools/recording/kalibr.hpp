// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Kalibr's camchain-imucam.yaml or camchain.yaml: the first camera, cam0. Failures name file, line and column: what is
/// missing, a lens that is no pinhole, a distortion that is neither radtan nor equidistant nor none.
Result<odo_calibration> read_camchain(const std::filesystem::path& file);

/// As camera.yaml has it (docs/recording.md), every digit.
std::string camera_yaml(const odo_calibration& camera);

}  // namespace odograph
