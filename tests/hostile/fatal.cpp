// SPDX-License-Identifier: Apache-2.0
#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  odo_plugin t = hostile::table();
  t.process = [](odo_instance*, const odo_batch*) -> int32_t { return ODO_E_FATAL; };
  return hostile::fill(out, t);
}
