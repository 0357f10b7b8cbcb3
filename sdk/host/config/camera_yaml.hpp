// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <odograph/types.h>

#include "sdk/host/config/spec.hpp"

namespace odograph {

/// Schema of camera.yaml; the source of `schemas/camera.schema.json`.
const Spec& camera_spec();

/// Reads camera.yaml: model, width, height, fx, fy, cx, cy, distortion, fps, mount, time offset, row time. `fps` may be
/// null. Failures state file, line and column.
Result<odo_calibration> read_camera_yaml(const std::filesystem::path& file, double* fps);

}  // namespace odograph
