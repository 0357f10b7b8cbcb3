// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sdk/plugin_host/manifest.hpp"

namespace odograph {

/// The plugins that lie on the search path, by their manifests. Looking runs no foreign code.
class PluginRegistry {
 public:
  /// Reads all manifests in the directories, in order. A directory that does not exist is skipped.
  explicit PluginRegistry(const std::vector<std::filesystem::path>& directories);

  /// The plugin with this id, or with this manifest path when `id` ends in ".odoplugin.json" (relative to `base`).
  /// Failures: unknown id with the nearest one, two manifests with one id, a kind it does not serve, not on `allow`
  /// (empty allows all).
  Result<const Manifest*> find(const std::string& id, const std::string& interface_id,
                               const std::filesystem::path& base, const std::vector<std::string>& allow);

  const std::vector<Manifest>& manifests() const { return manifests_; }
  /// Manifests that could not be read, as sentences.
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::filesystem::path> directories_;
  std::vector<Manifest> manifests_;
  std::vector<std::unique_ptr<Manifest>> explicit_;
  std::vector<std::string> problems_;
};

/// `first` in order, then $ODOGRAPH_PLUGIN_PATH, then the folder that belongs to this program or library.
std::vector<std::filesystem::path> plugin_directories(const std::vector<std::filesystem::path>& first);

}  // namespace odograph
