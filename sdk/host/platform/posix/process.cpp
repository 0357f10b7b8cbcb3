// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/process.hpp"

#include <unistd.h>

#include "sdk/host/platform/features.hpp"

namespace odograph {

const PlatformFeatures kPlatform{
    .name = "posix", .libraries = true, .processes = true, .threads = true, .path_separator = ':'};

int64_t this_process() noexcept { return getpid(); }

}  // namespace odograph
