// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace odograph {

/// Duplicates the descriptor above those with a fixed meaning in a plugin's process (wire.hpp) and closes `fd`. -1 if
/// `fd` is -1 or none is free.
int high_descriptor(int fd);

/// Creates anonymous shareable memory that cannot shrink, so that a process that maps it is safe from SIGBUS. -1 on
/// failure.
int shared_memory(const char* name, size_t bytes);

/// Maps `bytes` of it for reading and writing; null on failure.
void* map_shared(int fd, size_t bytes);

}  // namespace odograph
