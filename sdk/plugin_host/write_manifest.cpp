// SPDX-License-Identifier: Apache-2.0
#include "sdk/plugin_host/write_manifest.hpp"

#include <fstream>

#include "sdk/plugin_host/library.hpp"
#include "sdk/plugin_host/services.hpp"

namespace odograph {

Result<std::filesystem::path> write_manifest_beside(const std::filesystem::path& file) {
  const HostServices host(0, {"."}, nullptr);
  const auto library = PluginLibrary::load(file, &host);
  if (!library) return library.failure();
  const auto hash = sha256_of(file);
  if (!hash) return hash.failure();
  auto path = file;
  path.replace_extension();
  path += ".odoplugin.json";
  std::ofstream out(path, std::ios::binary);
  out << write_manifest((*library)->table(), file.filename().string(), *hash);
  if (!out.flush()) return Failure{ODO_E_NOT_FOUND, path.string() + ": cannot be written"};
  return path;
}

}  // namespace odograph
