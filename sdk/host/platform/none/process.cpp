// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/process.hpp"

#include "sdk/host/platform/features.hpp"

namespace odograph {

const PlatformFeatures kPlatform{
    .name = "none", .libraries = false, .processes = false, .threads = false, .path_separator = ':'};

int64_t this_process() noexcept { return 0; }

std::string environment_text(const char*) { return {}; }

}  // namespace odograph
