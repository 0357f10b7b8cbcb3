// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// The recommended pipeline for a walker's recording, as YAML: steps always, the camera and fixes where it has them.
/// For who has a recording and no config yet.
std::string default_config(const Recording& recording);

}  // namespace odograph
