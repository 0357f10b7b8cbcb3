// SPDX-License-Identifier: Apache-2.0
// A well-behaved fixer that emits a fix for each pose.
#define HOSTILE_ID "test/fix_on_pose"
#include <odograph/absolute_fixer.h>

#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string kind{ODO_INTERFACE_ABSOLUTE_FIXER, sizeof(ODO_INTERFACE_ABSOLUTE_FIXER) - 1};
  odo_plugin t = hostile::table();
  t.interfaces = &kind;
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    for (uint32_t i = 0; i < batch->count; ++i) {
      if (batch->messages[i]->type != ODO_TYPE_POSE) continue;
      const auto& pose = *reinterpret_cast<const odo_pose*>(batch->messages[i]);
      auto fix = hostile::make<odo_fix>(ODO_TYPE_FIX, pose.header.t_ns);
      fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
      fix.header.quality = 0.25f;
      for (int k = 0; k < 3; ++k) fix.p_n[k] = pose.p_n[k], fix.covariance_n[4 * k] = 1;
      hostile::sink()->emit(hostile::sink(), &fix.header);
    }
    return ODO_OK;
  };
  return hostile::fill(out, t);
}
