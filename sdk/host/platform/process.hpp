// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace odograph {

/// The number of this process: another one in a child that was forked. 0 where there are no processes. [any]
int64_t this_process() noexcept;

}  // namespace odograph
