// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace odograph {

/// Permanently removes from this process what a plugin does not need: address space beyond `memory_bytes`, creating
/// files, root capabilities, unlimited threads (through `gate`, thread_gate.hpp), foreign files (file_rules.hpp), and
/// every system call that is not on a list (call_filter.hpp). The process ends with its parent. Must be called while
/// single-threaded. Returns a phrase for each restriction that this system lacks. docs/security.md lists the guarantees
/// and their mechanisms.
std::vector<std::string> enter_sandbox(uint64_t memory_bytes, int gate);

}  // namespace odograph
