// SPDX-License-Identifier: Apache-2.0
// A level attitude that crashes at its 300th sample, in every life anew.
#define HOSTILE_ID "test/crashing_attitude"
#include <csignal>

#include <odograph/attitude.h>

#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string interfaces[] = {{ODO_INTERFACE_ATTITUDE, sizeof(ODO_INTERFACE_ATTITUDE) - 1}};
  odo_plugin t = hostile::table();
  t.interfaces = interfaces;
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    static int samples = 0;
    if (batch->messages[0]->type != ODO_TYPE_IMU) return ODO_OK;
    if (++samples == 300) raise(SIGSEGV);
    odo_attitude a;
    std::memset(static_cast<void*>(&a), 0, sizeof a);
    a.header = *batch->messages[0];
    a.header.struct_size = sizeof a, a.header.type = ODO_TYPE_ATTITUDE, a.header.flags = 0;
    a.q_n_b[0] = a.q_n_b[1] = 0.70710678118654757;  // the phone's y points up
    for (int i = 0; i < 3; ++i) a.covariance_n[4 * i] = 1e-3;
    return hostile::sink()->emit(hostile::sink(), &a.header);
  };
  return hostile::fill(out, t);
}
