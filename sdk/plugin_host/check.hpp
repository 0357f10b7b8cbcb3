// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace odograph {

/// One test of the plugin validator.
struct PluginCheck {
  std::string what;
  bool passed;
  std::string detail;
};

/// Puts a plugin library to the test: file format, entry, table, life of an instance, hostile input, repeatability and
/// independence of how the input is cut into batches. Whatever runs the plugin's code runs in a child process, so that
/// a crash is a failed test. `settings` are parameters, name and value, for plugins that have no good default.
/// [control]
std::vector<PluginCheck> check_plugin(const std::filesystem::path& library,
                                      const std::vector<std::pair<std::string, std::string>>& settings = {});

}  // namespace odograph
