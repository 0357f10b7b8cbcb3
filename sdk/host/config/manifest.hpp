// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <odograph/plugin.h>

#include "sdk/host/config/spec.hpp"

namespace odograph {

/// How a library is held against its manifest before it is opened.
enum class LibraryCheck : uint32_t {
  none,
  hash,    // it has the manifest's hash
  sealed,  // and what is opened is a sealed copy of what was hashed (sealed_copy.hpp)
};

/// NAME.odoplugin.json: a plugin library's table, readable without running it. Of a plugin that is linked into the
/// program it is made from the table itself, and there is no file.
struct Manifest {
  odo_plugin_entry entry = nullptr;  // of a linked-in plugin
  std::filesystem::path path;        // of the manifest
  std::string text;                  // as read, once: what is verified and what is used are the same
  std::filesystem::path library;     // absolute
  std::string id;
  std::string version;
  std::string summary;
  std::vector<std::string> interfaces;
  uint32_t abi_major = 0;
  uint32_t abi_minor = 0;
  std::string sha256;  // of the library, lower-case hex
  std::vector<Spec> parameters;

  /// Where the plugin is, for messages.
  std::string place() const { return entry ? "plugin '" + id + "', which is linked in" : library.string(); }
};

/// The manifest of a linked-in plugin. ODO_E_DATA as for parameter_specs.
Result<Manifest> manifest_of(const odo_plugin& plugin, odo_plugin_entry entry);

/// Reads a manifest. A failure names file, line and column.
Result<Manifest> read_manifest(const std::filesystem::path& path);

/// As read_manifest, of a text that was read from `path` before; the file is not looked at.
Result<Manifest> parse_manifest(std::string text, const std::filesystem::path& path);

/// The manifest's text for a loaded plugin table. `library` is its file name, `sha256` its hash.
std::string write_manifest(const odo_plugin& plugin, const std::string& library, const std::string& sha256);

/// A plugin's parameter table as specs. ODO_E_DATA when a row is smaller than version 1.0 of it or makes no sense.
Result<std::vector<Spec>> parameter_specs(const odo_plugin& plugin);

/// SHA-256 of a file in lower-case hex, or ODO_E_NOT_FOUND, also for what is no regular file: a pipe may never end.
Result<std::string> sha256_of(const std::filesystem::path& file);

/// The table that manifests are checked against; `schemas/odoplugin.schema.json` is made from it.
const Spec& manifest_spec();

}  // namespace odograph
