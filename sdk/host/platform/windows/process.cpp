// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/process.hpp"

#include <stdlib.h>

#include "sdk/host/platform/features.hpp"
#include "sdk/host/platform/utf8_path.hpp"

namespace odograph {

const PlatformFeatures kPlatform{
    .name = "windows", .libraries = true, .processes = false, .threads = true, .path_separator = ';'};

// There is no fork().
int64_t this_process() noexcept { return 0; }

std::string environment_text(const char* name) {
  const wchar_t* value = _wgetenv(utf8_path(name).c_str());
  return value ? utf8_text(value) : std::string();
}

}  // namespace odograph
