// SPDX-License-Identifier: Apache-2.0
//
// In the place of process_backend, sealed_copy, library_check and shared_pixels where no operating system is beneath
// (platform/none). Configs that ask for any of it were refused before, with the place in the config; these are the
// answers to callers of the functions themselves.
#include "sdk/host/platform/features.hpp"
#include "sdk/host/plugin_host/backend.hpp"
#include "sdk/host/plugin_host/library.hpp"
#include "sdk/host/plugin_host/sealed_copy.hpp"

namespace odograph {
namespace {

Failure unsupported(const std::filesystem::path& library, const std::string& what) {
  return {ODO_E_UNSUPPORTED, library.string() + ": this program's platform (" + kPlatform.name + ") has no " + what};
}

}  // namespace

Result<std::unique_ptr<PluginBackend>> open_process(const PluginChoice& choice, LibraryCheck, HostServices&,
                                                    const odo_sink&) {
  return unsupported(choice.manifest.library, "processes; expected 'isolation: none'");
}

Result<bool> check_shared_library(const std::filesystem::path&, const std::filesystem::path& name) {
  return unsupported(name, "shared libraries; expected a plugin that is linked in (odo_register_plugin)");
}

Result<std::filesystem::path> sealed_copy(const Manifest& manifest) {
  return unsupported(manifest.library, "shared libraries; expected a plugin that is linked in (odo_register_plugin)");
}

Result<bool> has_hash_of(const Manifest& manifest, const std::filesystem::path&) {
  return unsupported(manifest.library, "shared libraries; expected a plugin that is linked in (odo_register_plugin)");
}

SharedPixels::~SharedPixels() = default;

int SharedPixels::descriptor() { return -1; }
std::span<uint8_t> SharedPixels::take(size_t) { return {}; }
void SharedPixels::give_back(std::span<uint8_t>) {}
size_t SharedPixels::reserved() const { return 0; }
std::optional<uint64_t> SharedPixels::offset_of(const uint8_t*) const { return std::nullopt; }

}  // namespace odograph
