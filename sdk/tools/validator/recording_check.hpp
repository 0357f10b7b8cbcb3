// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "sdk/tools/validator/check.hpp"

namespace odograph {

/// Runs a plugin on the recording of the options, in one child process: reports how many messages of each type it
/// received and emitted, and runs the cases that check events of any input. A single call that takes `call_limit_s`
/// hangs. Ids begin with "recording.".
std::vector<PluginCheck> check_on_recording(const std::filesystem::path& library, const CheckOptions& options,
                                            double call_limit_s);

}  // namespace odograph
