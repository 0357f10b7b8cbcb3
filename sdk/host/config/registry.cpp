// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/registry.hpp"

#include <algorithm>

#include <odograph/types.h>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/config/linked_plugins.hpp"
#include "sdk/host/platform/file_access.hpp"
#include "sdk/host/platform/library.hpp"
#include "sdk/host/platform/process.hpp"
#include "sdk/host/platform/utf8_path.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {
constexpr std::string_view kSuffix = ".odoplugin.json";
constexpr size_t kMaxHints = 8;  // libraries without a manifest: a system directory has hundreds

bool is_manifest(const std::string& name) {
  return name.size() > kSuffix.size() && name.compare(name.size() - kSuffix.size(), kSuffix.size(), kSuffix) == 0;
}
}  // namespace

Result<fs::path> find_named(const std::string& name, const std::vector<fs::path>& folders) {
  const fs::path path = utf8_path(name);
  if (path.is_absolute()) return path;
  std::error_code error;
  for (const fs::path& folder : folders)
    if (folders.size() == 1 || fs::exists(folder / path, error)) return folder / path;
  if (folders.empty())
    return Failure{ODO_E_CONFIG,
                   "'" + name + "': no folder to search; expected an absolute path, or a folder in asset_path"};
  std::string text = "'" + name + "' is in none of the folders searched";
  for (const fs::path& folder : folders) text += (&folder == folders.data() ? ": " : ", ") + utf8_text(folder);
  return Failure{ODO_E_CONFIG, text};
}

namespace {

/// Whether the list contains its id, its manifest or library path, or its library's hash, which is verified on loading.
bool is_allowed(const Manifest& manifest, const std::vector<std::string>& allow, const std::vector<fs::path>& folders) {
  return std::any_of(allow.begin(), allow.end(), [&](const std::string& item) {
    if (item == manifest.id || (is_sha256(item) && item == manifest.sha256)) return true;
    std::error_code error;
    const auto path = find_named(item, folders);
    return path && (fs::equivalent(*path, manifest.library, error) || fs::equivalent(*path, manifest.path, error));
  });
}

/// The first world-writable path among manifest and library, with links resolved, and all their parent directories;
/// empty if there is none.
fs::path world_writable_path(const Manifest& manifest) {
  for (const fs::path& path : {manifest.path, manifest.library}) {
    std::error_code error;
    const fs::path real = fs::canonical(path, error);
    if (error) continue;
    for (const fs::path& each : {path.parent_path(), real.parent_path(), real})
      if (is_world_writable(each.empty() ? fs::path(".") : each, false)) return each;
    for (fs::path above = real.parent_path(); above.has_relative_path(); above = above.parent_path())
      if (is_world_writable(above, true)) return above;
  }
  return {};
}

/// Whether NAME.so has no NAME.odoplugin.json beside it.
bool lacks_manifest(const fs::path& file) {
  const fs::path ending = file.extension();
  std::error_code error;
  fs::path manifest = file;
  return (ending == ".so" || ending == ".dylib" || ending == ".dll") &&
         !fs::exists(manifest.replace_extension(kSuffix), error);
}

}  // namespace

bool is_sha256(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::vector<fs::path> path_list(std::string_view text, char separator) {
  std::vector<fs::path> paths;
  for (const auto& part : split(text, separator)) paths.push_back(utf8_path(part));
  return paths;
}

std::vector<fs::path> plugin_directories(const std::vector<fs::path>& first) {
  std::vector<fs::path> directories = first;
  for (auto& directory : path_list(environment_text("ODOGRAPH_PLUGIN_PATH")))
    directories.push_back(std::move(directory));
  const fs::path binary = own_file();
  if (!binary.empty()) {  // PREFIX/lib[/TRIPLET]/libodograph.so or PREFIX/bin/odograph
    directories.push_back(binary.parent_path() / "odograph/plugins");
    directories.push_back(binary.parent_path() / ODOGRAPH_FROM_BIN / "plugins");
  }
  return directories;
}

PluginRegistry::PluginRegistry(const std::vector<fs::path>& directories, size_t asked_for) : linked_(linked_plugins()) {
  std::vector<fs::path> seen;
  for (size_t i = 0; i < directories.size(); ++i) {
    std::error_code error;
    const fs::path real = fs::canonical(directories[i], error);
    if (i < asked_for && (error || !fs::is_directory(real, error)))
      hints_.push_back("there is no folder " + directories[i].string());
    if (error || std::find(seen.begin(), seen.end(), real) != seen.end()) continue;
    seen.push_back(real);
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(real, error)) {
      if (is_manifest(entry.path().filename().string())) files.push_back(entry.path());
      if (lacks_manifest(entry.path()) && hints_.size() < kMaxHints)
        hints_.push_back(entry.path().string() + " has no manifest: `odograph plugin manifest` writes it");
    }
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
      auto manifest = read_manifest(file);
      if (!manifest)
        problems_.push_back(manifest.failure().text);
      else if (manifest->abi_major != ODO_ABI_MAJOR)
        problems_.push_back(file.string() + ": it is for ABI " + std::to_string(manifest->abi_major) +
                            ", this host is " + std::to_string(ODO_ABI_MAJOR));
      else
        manifests_.push_back(std::move(*manifest));
    }
  }
  directories_ = std::move(seen);
}

Result<const Manifest*> PluginRegistry::find(const std::string& id, const std::string& interface_id,
                                             const std::vector<fs::path>& folders,
                                             const std::vector<std::string>& allow) {
  const Manifest* found = nullptr;
  if (is_manifest(id)) {
    const auto path = find_named(id, folders);
    if (!path) return path.failure();
    auto manifest = read_manifest(*path);
    if (!manifest) return manifest.failure();
    found = explicit_.emplace_back(std::make_unique<Manifest>(std::move(*manifest))).get();
  }
  std::vector<std::string> usable;
  for (const auto* manifests : {&linked_, &manifests_})
    for (const Manifest& manifest : *manifests) {
      const auto& kinds = manifest.interfaces;
      if (std::find(kinds.begin(), kinds.end(), interface_id) != kinds.end()) usable.push_back(manifest.id);
      if (manifest.id != id) continue;
      if (found && found->path.parent_path() == manifest.path.parent_path())
        return Failure{ODO_E_CONFIG, "two plugins have the id '" + id + "': " + found->path.string() + " and " +
                                         manifest.path.string() + "; expected one, or the path of one manifest"};
      if (!found) found = &manifest;  // the first folder has precedence
    }
  if (!found) return not_found(id, interface_id, usable);
  if (std::find(found->interfaces.begin(), found->interfaces.end(), interface_id) == found->interfaces.end())
    return Failure{ODO_E_CONFIG,
                   "plugin '" + found->id + "' serves " + join(found->interfaces) + "; expected one that serves " +
                       interface_id +
                       (usable.empty() ? "" : ": " + join(usable) + " (nearest: '" + nearest(id, usable) + "')")};
  if (!allow.empty() && !is_allowed(*found, allow, folders))
    return Failure{ODO_E_CONFIG, "plugin '" + found->id +
                                     "' is not on the allow list (plugins.allow); expected one of " + join(allow) +
                                     " (nearest: '" + nearest(found->id, allow) + "')"};
  if (const auto loadable = may_be_loaded(*found, is_manifest(id)); !loadable) return loadable.failure();
  return found;
}

Failure PluginRegistry::not_found(const std::string& id, const std::string& interface_id,
                                  const std::vector<std::string>& usable) const {
  std::string text = "no plugin '" + id + "'";
  if (!kPlatform.libraries)
    return {ODO_E_NOT_FOUND,
            "plugin '" + id + "' is not linked into this program, whose platform (" + kPlatform.name +
                ") loads none from a file; " +
                (usable.empty() ? "there is no plugin for " + interface_id
                                : "expected one of " + join(usable) + " (nearest: '" + nearest(id, usable) + "')") +
                ", or odo_register_plugin before"};
  text += usable.empty() ? "; no plugin for " + interface_id + " lies in "
                         : "; expected one of " + join(usable) + " (nearest: '" + nearest(id, usable) + "'), from ";
  for (size_t i = 0; i < directories_.size(); ++i)
    text += (i ? std::string(1, kPlatform.path_separator) : "") + directories_[i].string();
  if (directories_.empty()) text += "any directory";
  for (const auto& problem : problems_) text += "; skipped: " + problem;
  for (const auto& hint : hints_) text += "; " + hint;
  return {ODO_E_NOT_FOUND, text};
}

/// A linked-in plugin has no file that could have been replaced. A manifest selected by path states its own id, so a
/// forged id must not exempt it from the signature rules.
Result<bool> PluginRegistry::may_be_loaded(const Manifest& manifest, bool by_path) const {
  if (manifest.entry) return true;
  if (!kPlatform.libraries)
    return Failure{ODO_E_UNSUPPORTED, manifest.path.string() + ": this program's platform (" + kPlatform.name +
                                          ") loads no plugin from a file; expected one that is linked in and "
                                          "registered (odo_register_plugin)"};
  if (const fs::path open = allow_writable_ ? fs::path() : world_writable_path(manifest); !open.empty())
    return Failure{ODO_E_CONFIG,
                   "plugin '" + manifest.id + "': " + open.string() +
                       " may be written to by every user; expected 'chmod o-w', or plugins.allow_writable"};
  std::vector<std::string> keys;
  for (const Signer& signer : signers_)
    if (signer.covers(manifest.id)) keys.push_back(signer.key);
  if (!keys.empty()) return verify_signature(manifest, keys);
  if (by_path && !signers_.empty())
    return Failure{ODO_E_CONFIG, "plugin '" + manifest.id + "': " + manifest.path.string() +
                                     " is chosen by its path, and none of plugins.signers covers its id; expected "
                                     "its id in the config, or a signer for it"};
  return true;
}

}  // namespace odograph
