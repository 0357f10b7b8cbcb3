// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace odograph {

/// The number of this process: another one in a child that was forked. 0 where there are no processes. [any]
int64_t this_process() noexcept;

/// A variable of the environment, in UTF-8; empty where it is not set. [control]
std::string environment_text(const char* name);

}  // namespace odograph
