// SPDX-License-Identifier: Apache-2.0
// The correct plugin that the others are variations of.
#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) { return hostile::fill(out, hostile::table()); }

// A second plugin of the same library, with a manifest of its own.
extern "C" ODO_EXPORT int32_t odo_plugin_entry_v1_second(const odo_host*, odo_plugin* out) {
  odo_plugin table = hostile::table();
  static const char id[] = "test/second";
  table.id = {id, sizeof id - 1};
  return hostile::fill(out, table);
}
