// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <odograph/plugin.h>

#include "sdk/host/config/spec.hpp"

namespace odograph {

/// How a library is checked against its manifest before it is opened.
enum class LibraryCheck : uint32_t {
  none,
  hash,    // its hash equals the manifest's
  sealed,  // as hash, and the library opened is a sealed copy of the hashed bytes (sealed_copy.hpp)
};

/// NAME.odoplugin.json: a plugin library's table, readable without running its code. For a plugin linked into the
/// program, the manifest is built from the table, without a file.
struct Manifest {
  odo_plugin_entry entry = nullptr;                    // of a linked-in plugin
  std::filesystem::path path;                          // of the manifest
  std::string text;                                    // as read once, so that the text used is the text verified
  std::filesystem::path library;                       // absolute
  std::string entry_symbol = ODO_PLUGIN_ENTRY_SYMBOL;  // several plugins in a library: several entries and manifests
  std::string id;
  std::string version;
  std::string summary;
  std::vector<std::string> interfaces;
  uint32_t abi_major = 0;
  uint32_t abi_minor = 0;
  std::string sha256;  // of the library, lower-case hex
  std::vector<Spec> parameters;

  /// Location of the plugin, for messages.
  std::string place() const { return entry ? "plugin '" + id + "', which is linked in" : library.string(); }
};

/// Builds the manifest of a linked-in plugin. Fails as parameter_specs().
Result<Manifest> manifest_of(const odo_plugin& plugin, odo_plugin_entry entry);

/// Reads a manifest. A failure states file, line and column.
Result<Manifest> read_manifest(const std::filesystem::path& path);

/// As read_manifest(), from a text already read from `path`; does not access the file.
Result<Manifest> parse_manifest(std::string text, const std::filesystem::path& path);

/// Formats the manifest of a loaded plugin table. `library` is its file name, `sha256` its hash.
std::string write_manifest(const odo_plugin& plugin, const std::string& library, const std::string& sha256);

/// Converts a plugin's parameter table to specs. ODO_E_DATA if a row is smaller than in version 1.0 or invalid.
Result<std::vector<Spec>> parameter_specs(const odo_plugin& plugin);

/// SHA-256 of a file in lower-case hex. ODO_E_NOT_FOUND if it cannot be read or is not a regular file: a pipe may never
/// end.
Result<std::string> sha256_of(const std::filesystem::path& file);

/// Schema of manifests; the source of `schemas/odoplugin.schema.json`.
const Spec& manifest_spec();

}  // namespace odograph
