// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/process.hpp"

#include <cstdlib>

#include <unistd.h>

#include "sdk/host/platform/features.hpp"

namespace odograph {

const PlatformFeatures kPlatform{
    .name = "posix", .libraries = true, .processes = true, .threads = true, .path_separator = ':'};

int64_t this_process() noexcept { return getpid(); }

std::string environment_text(const char* name) {
#if defined(__GLIBC__)
  const char* value = secure_getenv(name);  // null in a program with more rights than its caller
#else
  const char* value = std::getenv(name);
#endif
  return value ? value : "";
}

}  // namespace odograph
