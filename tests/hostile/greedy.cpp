// SPDX-License-Identifier: Apache-2.0
// An attitude source that allocates and uses memory without end.
#define HOSTILE_ID "test/greedy"
#include <cstdlib>

#include <odograph/attitude.h>

#include "tests/hostile/table.hpp"

HOSTILE_PLUGIN {
  HOSTILE_SERVES(t, ODO_INTERFACE_ATTITUDE);
  t.process = [](odo_instance*, const odo_batch*) -> int32_t {
    static void* volatile used;  // without it clang leaves the allocation out
    for (;;) {
      void* memory = std::malloc(1 << 20);
      if (!memory) std::abort();
      used = std::memset(memory, 1, 1 << 20);
    }
  };
}
