// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <odograph/plugin.h>

#include "sdk/host/base/result.hpp"
#include "sdk/host/config/manifest.hpp"

namespace odograph {

/// A loaded plugin library, or a linked-in plugin, and its table. Never unloaded. [control]
class PluginLibrary {
 public:
  /// Checks the file format before the dynamic loader opens it (the loader may crash on a truncated file), loads it
  /// with RTLD_NOW | RTLD_LOCAL, calls the entry function and checks the table. Failures name the path and the reason.
  static Result<std::shared_ptr<PluginLibrary>> load(const std::filesystem::path& path, const odo_host* host);

  /// As load(), after comparing the library's hash with the manifest's according to `check`; also compares the id. A
  /// linked-in plugin has no file to check.
  static Result<std::shared_ptr<PluginLibrary>> load(const Manifest& manifest, LibraryCheck check,
                                                     const odo_host* host);

  /// The plugin's table; members missing in a smaller table are null.
  const odo_plugin& table() const { return table_; }
  const std::filesystem::path& path() const { return path_; }

  bool quarantined() const { return quarantined_; }
  void quarantine() { quarantined_ = true; }

 private:
  /// `path` names it in messages; `opened` is the file that the loader opens, `symbol` the entry in it.
  static Result<std::shared_ptr<PluginLibrary>> open(const std::filesystem::path& path,
                                                     const std::filesystem::path& opened, const std::string& symbol,
                                                     const odo_host* host);

  std::filesystem::path path_;
  odo_plugin table_{};
  bool quarantined_ = false;
};

/// Registers a plugin that is linked into the program (odo_register_plugin). A failure states the reason. [any]
Result<bool> register_plugin(odo_plugin_entry entry);

/// Whether the file is a shared library for this machine, with all its segments present. A failure calls it `name`.
Result<bool> check_shared_library(const std::filesystem::path& path, const std::filesystem::path& name);

}  // namespace odograph
