// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Writes the source of a new plugin to `folder`, which is created and must not contain these files: the plugin, its
/// build files, README.md and pipeline.yaml. It builds against an installed Odograph, passes `plugin check` and runs
/// unchanged. `kind`: attitude, step_estimator, vo_frontend, scale_source, absolute_fixer or surface_finder; `id`:
/// group/name; `language`: c++ (17), c (99), rust or python. `repository`: with ci/check, the workflows of GitHub and
/// GitLab, and .gitignore; not in Python.
Result<bool> write_plugin_skeleton(const std::string& kind, const std::string& id, const std::filesystem::path& folder,
                                   const std::string& language, bool repository);

}  // namespace odograph
