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

/// The plugins that are linked into the program, and those that lie on the search path, by their manifests. Looking
/// runs no foreign code.
class PluginRegistry {
 public:
  /// Reads all manifests in the directories, in order. A directory that does not exist is skipped; one of the first
  /// `asked_for`, which a user named, is said where a plugin is not found, as are libraries without a manifest.
  explicit PluginRegistry(const std::vector<std::filesystem::path>& directories, size_t asked_for = 0);

  /// The plugin with this id, of the linked-in ones before those in folders, or with this manifest path when `id` ends
  /// in
  /// ".odoplugin.json" (relative to `base`).
  /// Failures: unknown id with the nearest one, two manifests with one id, a kind it does not serve, not on `allow`
  /// (ids, paths of manifest or library, SHA-256 of the library; empty allows all), or open to everybody's writing:
  /// itself, where a link leads to, or a folder above without the sticky bit. What is linked in has its id and kind
  /// checked alone.
  Result<const Manifest*> find(const std::string& id, const std::string& interface_id,
                               const std::filesystem::path& base, const std::vector<std::string>& allow);

  /// Whether plugins may come from folders and files that every user of the machine may write to; at first not.
  void allow_writable(bool allowed) { allow_writable_ = allowed; }

  /// A plugin that any of them vouches for must be signed by one of those that do; others need no signature.
  void require_signature(std::vector<Signer> signers) { signers_ = std::move(signers); }

  /// Those in folders.
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

/// 64 hexadecimal digits.
bool is_sha256(const std::string& text);

/// The directories of a list like $PATH; empty parts are dropped.
std::vector<std::filesystem::path> path_list(std::string_view text, char separator = kPlatform.path_separator);

/// `first` in order, then $ODOGRAPH_PLUGIN_PATH, then the folder that belongs to this program or library.
std::vector<std::filesystem::path> plugin_directories(const std::vector<std::filesystem::path>& first);

}  // namespace odograph
