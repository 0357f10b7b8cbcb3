// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/config/spec.hpp"

namespace odograph {
/// The table of camera.yaml; `schemas/camera.schema.json` is made from it.
const Spec& camera_spec();
}  // namespace odograph
