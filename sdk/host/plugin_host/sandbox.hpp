// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace odograph {

/// Takes from this process what a plugin does not need, for good: memory beyond `memory_bytes` of address space, core
/// files, new privileges; and where the system has seccomp, programs, other processes, the network, and every change of
/// files. Reading files, memory and threads stay. Returns whether the system calls are filtered. docs/security.md says
/// what is refused and what is not.
bool enter_sandbox(uint64_t memory_bytes);

}  // namespace odograph
