// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/process.hpp"

#include <filesystem>

#include <stdlib.h>

#include "sdk/host/platform/features.hpp"

namespace odograph {

const PlatformFeatures kPlatform{
    .name = "windows", .libraries = true, .processes = false, .threads = true, .path_separator = ';'};

// No process here is another one's copy.
int64_t this_process() noexcept { return 0; }

std::string environment_text(const char* name) {
  const wchar_t* value = _wgetenv(std::filesystem::path(name).c_str());
  return value ? std::filesystem::path(value).string() : std::string();  // in UTF-8: libstdc++'s narrow paths are
}

}  // namespace odograph
