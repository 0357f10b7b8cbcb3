// SPDX-License-Identifier: Apache-2.0
// A well-behaved step estimator that emits a step for each fix.
#define HOSTILE_ID "test/step_on_fix"
#include <odograph/step_estimator.h>

#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string kind{ODO_INTERFACE_STEP_ESTIMATOR, sizeof(ODO_INTERFACE_STEP_ESTIMATOR) - 1};
  odo_plugin t = hostile::table();
  t.interfaces = &kind;
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    for (uint32_t i = 0; i < batch->count; ++i) {
      if (batch->messages[i]->type != ODO_TYPE_FIX) continue;
      auto step = hostile::make<odo_step>(ODO_TYPE_STEP, batch->messages[i]->t_ns + 1);
      step.t_end_ns = step.header.t_ns;
      step.header.flags = ODO_STEP_HEADING;
      step.t_start_ns = step.t_end_ns - 500000000;
      step.length_m = 0.7;
      step.sigma_m = 0.1;
      step.frequency_hz = 2;
      hostile::sink()->emit(hostile::sink(), &step.header);
    }
    return ODO_OK;
  };
  return hostile::fill(out, t);
}
