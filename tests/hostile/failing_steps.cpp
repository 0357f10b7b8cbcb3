// SPDX-License-Identifier: Apache-2.0
// A step estimator that always fails.
#define HOSTILE_ID "test/failing_steps"
#include <odograph/step_estimator.h>

#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string interfaces[] = {{ODO_INTERFACE_STEP_ESTIMATOR, sizeof(ODO_INTERFACE_STEP_ESTIMATOR) - 1}};
  odo_plugin t = hostile::table();
  t.interfaces = interfaces;
  t.process = [](odo_instance*, const odo_batch*) -> int32_t { return ODO_E_ERROR; };
  return hostile::fill(out, t);
}
