// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace odograph {

/// Takes from this process what a plugin does not need, for good: memory beyond `memory_bytes` of address space, files
/// of its own, rights of root, its threads' number (asked for by `gate`, thread_gate.hpp), files of others
/// (file_rules.hpp), and every system call that is not on a list (call_filter.hpp). It ends with its parent. One thread
/// so far. Returns what this system cannot do, a phrase each. docs/security.md has what is promised, by which means.
std::vector<std::string> enter_sandbox(uint64_t memory_bytes, int gate);

}  // namespace odograph
