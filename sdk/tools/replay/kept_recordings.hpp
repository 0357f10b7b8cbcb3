// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// A file's text, or why there is none.
Result<std::string> text_of(const std::filesystem::path& file);

/// The recording of a scenario and seed in the folder `keep`, made now unless it is kept there from an earlier run of
/// the same scenario by the same simulator. `first_m` above 0: only that much of the path. Shows progress.
Result<std::filesystem::path> kept_recording(const std::filesystem::path& scenario, uint64_t seed,
                                             const std::filesystem::path& keep, double first_m);

/// The folder beside a kept recording with what belongs to it: the generated town's model, `city.json`.
std::filesystem::path assets_of(const std::filesystem::path& recording);

}  // namespace odograph
