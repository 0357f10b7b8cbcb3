// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// The recommended pipeline for a walker's recording, as YAML: always with steps, with camera and fixes if recorded.
/// For users without a config.
std::string default_config(const Recording& recording);

}  // namespace odograph
