// SPDX-License-Identifier: Apache-2.0
// Reports success of create but returns no instance.
#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  odo_plugin t = hostile::table();
  t.create = [](const odo_host*, uint32_t, const odo_string*, odo_instance**) -> int32_t { return ODO_OK; };
  return hostile::fill(out, t);
}
