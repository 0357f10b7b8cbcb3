// SPDX-License-Identifier: Apache-2.0
// Reports success of create but returns no instance.
#include "tests/hostile/table.hpp"

HOSTILE_PLUGIN {
  t.create = [](const odo_host*, uint32_t, const odo_string*, odo_instance**) -> int32_t { return ODO_OK; };
}
