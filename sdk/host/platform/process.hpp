// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace odograph {

/// Process id, which differs in a forked child. 0 on platforms without processes. [any]
int64_t this_process() noexcept;

/// An environment variable in UTF-8; empty if not set. [control]
std::string environment_text(const char* name);

}  // namespace odograph
