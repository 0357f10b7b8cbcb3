// SPDX-License-Identifier: Apache-2.0
// A horizontal attitude that crashes at its 300th sample, after each restart.
#define HOSTILE_ID "test/crashing_attitude"
#include <csignal>

#include "tests/hostile/horizontal_attitude.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string interfaces[] = {{ODO_INTERFACE_ATTITUDE, sizeof(ODO_INTERFACE_ATTITUDE) - 1}};
  odo_plugin t = hostile::table();
  t.interfaces = interfaces;
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    static int samples = 0;
    if (batch->messages[0]->type != ODO_TYPE_IMU) return ODO_OK;
    if (++samples == 300) raise(SIGSEGV);
    return hostile::emit_horizontal_attitude(*batch->messages[0]);
  };
  return hostile::fill(out, t);
}
