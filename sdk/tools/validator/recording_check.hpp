// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "sdk/tools/validator/check.hpp"

namespace odograph {

/// Gives a plugin the recording of the options, in one child process: how many messages of each type it was given and
/// emitted, and the cases that judge the events of any input. Ids begin with "recording.".
std::vector<PluginCheck> check_on_recording(const std::filesystem::path& library, const CheckOptions& options);

}  // namespace odograph
