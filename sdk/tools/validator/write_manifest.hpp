// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Loads a plugin library and writes NAME.odoplugin.json beside it. Returns the manifest's path.
Result<std::filesystem::path> write_manifest_beside(const std::filesystem::path& library);

}  // namespace odograph
