// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <odograph/types.h>

#include "sdk/host/config/spec.hpp"

namespace odograph {

/// The table of camera.yaml; `schemas/camera.schema.json` is made from it.
const Spec& camera_spec();

/// camera.yaml: model, width, height, fx, fy, cx, cy, distortion, fps, mount, time offset, row time. `fps` may be null.
/// Failures name file, line and column.
Result<odo_calibration> read_camera_yaml(const std::filesystem::path& file, double* fps);

}  // namespace odograph
