// SPDX-License-Identifier: Apache-2.0
//
// Replaces process_backend and shared_pixels on platforms without processes. A config that requests a process has been
// refused before, with the line in the config; these failures are for direct callers.
#include "sdk/host/platform/features.hpp"
#include "sdk/host/plugin_host/backend.hpp"

namespace odograph {

Result<std::unique_ptr<PluginBackend>> open_process(const PluginChoice& choice, LibraryCheck, HostServices&,
                                                    const odo_sink&) {
  return Failure{ODO_E_UNSUPPORTED, choice.manifest.library.string() + ": this program's platform (" + kPlatform.name +
                                        ") has no processes; expected 'isolation: none'"};
}

SharedPixels::~SharedPixels() = default;

int SharedPixels::descriptor() { return -1; }
std::span<uint8_t> SharedPixels::take(size_t) { return {}; }
void SharedPixels::give_back(std::span<uint8_t>) {}
size_t SharedPixels::reserved() const { return 0; }
std::optional<uint64_t> SharedPixels::offset_of(const uint8_t*) const { return std::nullopt; }

}  // namespace odograph
