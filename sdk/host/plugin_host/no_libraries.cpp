// SPDX-License-Identifier: Apache-2.0
//
// Replaces sealed_copy and library_check on platforms without shared libraries (platform/none).
#include "sdk/host/platform/features.hpp"
#include "sdk/host/plugin_host/library.hpp"
#include "sdk/host/plugin_host/sealed_copy.hpp"

namespace odograph {
namespace {

Failure unsupported(const std::filesystem::path& library) {
  return {ODO_E_UNSUPPORTED,
          library.string() + ": this program's platform (" + kPlatform.name +
              ") has no shared libraries; expected a plugin that is linked in (odo_register_plugin)"};
}

}  // namespace

Result<bool> check_shared_library(const std::filesystem::path&, const std::filesystem::path& name) {
  return unsupported(name);
}

Result<std::filesystem::path> sealed_copy(const Manifest& manifest) { return unsupported(manifest.library); }

Result<bool> has_hash_of(const Manifest& manifest, const std::filesystem::path&) {
  return unsupported(manifest.library);
}

}  // namespace odograph
