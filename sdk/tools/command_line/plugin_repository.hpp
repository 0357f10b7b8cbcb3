// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Writes beside a new plugin (write_plugin_skeleton) what makes its folder a repository: ci/check, the files with
/// which GitHub and GitLab run it, and .gitignore. `id`: group/name, `language`: c++, c or rust. ODO_E_ARGUMENT
/// where one of them is there already.
Result<bool> write_plugin_repository(const std::string& id, const std::filesystem::path& folder,
                                     const std::string& language);

}  // namespace odograph
