// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/write_manifest.hpp"

#include <fstream>

#include "sdk/host/plugin_host/library.hpp"
#include "sdk/host/plugin_host/services.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
namespace {
constexpr double kLimit_s = 60;  // for loading a library and reading its table on a busy or emulated machine
}

Result<std::filesystem::path> write_manifest_beside(const std::filesystem::path& file) {
  const auto hash = sha256_of(file);
  if (!hash) return hash.failure();
  // The plugin's code runs only in the child, which returns the manifest's text after a '+', or a reason.
  const ChildResult made = run_in_child(kLimit_s, [&] {
    note_phase("loading");
    const HostServices host(0, {"."}, nullptr);
    const auto library = PluginLibrary::load(file, &host);
    if (!library) return library.failure().text;
    return "+" + write_manifest((*library)->table(), file.filename().string(), *hash);
  });
  if (!made.finished) return Failure{ODO_E_FATAL, file.string() + ": " + made.text};
  if (made.text.empty() || made.text[0] != '+') return Failure{ODO_E_DATA, made.text};
  auto path = file;
  path.replace_extension();
  path += ".odoplugin.json";
  std::ofstream out(path, std::ios::binary);
  out << made.text.substr(1);
  if (!out.flush()) return Failure{ODO_E_IO, path.string() + ": cannot be written"};
  return path;
}

}  // namespace odograph
