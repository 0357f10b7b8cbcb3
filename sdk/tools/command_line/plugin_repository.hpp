// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Adds to a new plugin (write_plugin_skeleton) the files that make its folder a repository: ci/check, the workflows of
/// GitHub and GitLab, and .gitignore. `id`: group/name, `language`: c++, c or rust. ODO_E_ARGUMENT if one of the files
/// exists.
Result<bool> write_plugin_repository(const std::string& id, const std::filesystem::path& folder,
                                     const std::string& language);

}  // namespace odograph
