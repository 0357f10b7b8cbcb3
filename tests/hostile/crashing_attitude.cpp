// SPDX-License-Identifier: Apache-2.0
// A horizontal attitude that crashes at its 300th sample, after each restart.
#define HOSTILE_ID "test/crashing_attitude"
#include <csignal>

#include "tests/hostile/horizontal_attitude.hpp"

HOSTILE_PLUGIN {
  HOSTILE_SERVES(t, ODO_INTERFACE_ATTITUDE);
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    static int samples = 0;
    if (batch->messages[0]->type != ODO_TYPE_IMU) return ODO_OK;
    if (++samples == 300) raise(SIGSEGV);
    return hostile::emit_horizontal_attitude(*batch->messages[0]);
  };
}
