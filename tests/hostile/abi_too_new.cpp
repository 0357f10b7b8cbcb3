// SPDX-License-Identifier: Apache-2.0
#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  odo_plugin t = hostile::table();
  t.abi_major = 3;
  return hostile::fill(out, t);
}
