// SPDX-License-Identifier: Apache-2.0
// Built against a later minor version with a larger table, which it writes completely. The host must survive that.
#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  struct Larger {
    odo_plugin known;
    void* later[16];
  } larger;
  std::memset(&larger, 0x5A, sizeof larger);
  larger.known = hostile::table();
  larger.known.struct_size = sizeof larger;
  std::memcpy(static_cast<void*>(out), &larger, sizeof larger);
  return ODO_OK;
}
