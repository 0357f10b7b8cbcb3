// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

/// What a plugin in a process of its own may not be able to do to its host, its user or its machine: named attempts,
/// each true where it came off. The tests say in the environment which process the host is, and which folder is the
/// victim.
namespace hostile {

struct Attempt {
  const char* name;
  bool (*done)();
};

inline int host_process() { return std::atoi(std::getenv("ODOGRAPH_TEST_HOST")); }
inline const char* victim() { return std::getenv("ODOGRAPH_TEST_VICTIM"); }

struct Attempts {
  const Attempt* first;
  unsigned long count;
};
Attempts on_processes();
Attempts on_files();

}  // namespace hostile
