// SPDX-License-Identifier: Apache-2.0
// A scale source that answers each motion with a scale for the previous one, and every third time with a valid one.
#define HOSTILE_ID "test/late_scale"
#include <odograph/scale_source.h>

#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  odo_plugin t = hostile::table();
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    static uint32_t motions = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
      if (batch->messages[i]->type != ODO_TYPE_VO_MOTION) continue;
      odo_vo_motion motion;
      odo_copy(&motion, sizeof motion, batch->messages[i]);
      auto scale = hostile::make<odo_scale>(ODO_TYPE_SCALE, motion.header.t_ns);
      scale.scale = 1, scale.sigma = 0.1;
      scale.scale_group = motion.scale_group;
      scale.valid_to_ns = ++motions % 3 == 0 ? motion.header.t_ns : motion.t_from_ns;
      scale.valid_from_ns = scale.valid_to_ns - 1;
      hostile::sink()->emit(hostile::sink(), &scale.header);
    }
    return ODO_OK;
  };
  return hostile::fill(out, t);
}
