// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

/// Attacks of an isolated plugin on its host, its user or its machine: named attempts, each true if it succeeded. The
/// tests pass the host process and the target folder in the environment.
namespace hostile {

struct Attempt {
  const char* name;
  bool (*done)();
};

inline int host_process() { return std::atoi(std::getenv("ODOGRAPH_TEST_HOST")); }
inline const char* target_folder() { return std::getenv("ODOGRAPH_TEST_VICTIM"); }

struct Attempts {
  const Attempt* first;
  unsigned long count;
};
Attempts on_processes();
Attempts on_files();

}  // namespace hostile
