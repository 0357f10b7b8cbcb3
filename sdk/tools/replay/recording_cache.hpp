// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// A file's text.
Result<std::string> text_of(const std::filesystem::path& file);

/// Of a scenario or a model and the simulator's version: part of the names of kept files that were simulated from it.
std::string simulator_mark(const std::string& content);

/// The recording of a scenario and seed in the folder `keep`; simulated unless an earlier run of the same scenario and
/// simulator version left it there. `first_m` above 0 limits the path. Shows progress.
Result<std::filesystem::path> cached_recording(const std::filesystem::path& scenario, uint64_t seed,
                                               const std::filesystem::path& keep, double first_m);

/// The folder beside a kept recording with its assets: the generated town's model, `city.json`.
std::filesystem::path assets_of(const std::filesystem::path& recording);

}  // namespace odograph
