// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sdk/host/config/manifest.hpp"
#include "sdk/host/config/signature.hpp"
#include "sdk/host/platform/features.hpp"

namespace odograph {

/// The plugins linked into the program and those on the search path, from their manifests. Listing them runs no plugin
/// code.
class PluginRegistry {
 public:
  /// Reads all manifests in the directories, in order. A missing directory is skipped. If a plugin is not found, the
  /// error names missing directories among the first `asked_for`, which the user gave, and libraries without a
  /// manifest.
  explicit PluginRegistry(const std::vector<std::filesystem::path>& directories, size_t asked_for = 0);

  /// Finds a plugin by id, linked-in plugins first, or by manifest path if `id` ends in ".odoplugin.json" (searched in
  /// `folders`). Fails for an unknown id (with the nearest one), two manifests with one id, an interface that it does
  /// not serve, a plugin that is not on `allow` (ids, paths of manifest or library, SHA-256 of the library; empty
  /// allows all), and a world-writable file, link target, or parent directory without the sticky bit. For a linked-in
  /// plugin, only id and interface are checked.
  Result<const Manifest*> find(const std::string& id, const std::string& interface_id,
                               const std::vector<std::filesystem::path>& folders,
                               const std::vector<std::string>& allow);

  /// Whether plugins may be loaded from world-writable folders and files; the default is no.
  void allow_writable(bool allowed) { allow_writable_ = allowed; }

  /// A plugin whose id matches some signers' patterns must be signed by one of those signers; others need no signature.
  void require_signature(std::vector<Signer> signers) { signers_ = std::move(signers); }

  /// Plugins found in folders.
  const std::vector<Manifest>& manifests() const { return manifests_; }
  /// Manifests that could not be read, as sentences.
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  Failure not_found(const std::string& id, const std::string& interface_id,
                    const std::vector<std::string>& usable) const;
  Result<bool> may_be_loaded(const Manifest& manifest, bool by_path) const;

  std::vector<Manifest> linked_;
  std::vector<std::filesystem::path> directories_;
  std::vector<Manifest> manifests_;
  std::vector<std::unique_ptr<Manifest>> explicit_;
  std::vector<std::string> problems_, hints_;
  bool allow_writable_ = false;
  std::vector<Signer> signers_;
};

/// The file or folder that a config names: an absolute name, or a relative one in the first folder that has it. Never
/// in the process's current folder. ODO_E_CONFIG names the folders searched; with a single folder, the name in it is
/// returned in any case, so that its reader states the reason.
Result<std::filesystem::path> find_named(const std::string& name, const std::vector<std::filesystem::path>& folders);

/// 64 hexadecimal digits.
bool is_sha256(const std::string& text);

/// Splits a list like $PATH; empty parts are dropped.
std::vector<std::filesystem::path> path_list(std::string_view text, char separator = kPlatform.path_separator);

/// `first` in order, then $ODOGRAPH_PLUGIN_PATH, then the default folder of this program or library.
std::vector<std::filesystem::path> plugin_directories(const std::vector<std::filesystem::path>& first);

}  // namespace odograph
