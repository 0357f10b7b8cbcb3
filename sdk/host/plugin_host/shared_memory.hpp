// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace odograph {

/// A copy of the descriptor above those that a plugin's process gives a meaning to (wire.hpp); `fd` itself is closed.
/// -1 where `fd` is -1 or none is free.
int high_descriptor(int fd);

/// Anonymous memory that can be shared and never shrinks: whoever maps it is safe from SIGBUS. -1 where there is none.
int shared_memory(const char* name, size_t bytes);

/// `bytes` of it, to read and to write; null where it cannot be mapped.
void* map_shared(int fd, size_t bytes);

}  // namespace odograph
