// SPDX-License-Identifier: Apache-2.0
// A scale source that answers each motion with a scale for the previous one, and every third time with a valid one.
#define HOSTILE_ID "test/late_scale"
#include <odograph/scale_source.h>

#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string kind{ODO_INTERFACE_SCALE_SOURCE, sizeof(ODO_INTERFACE_SCALE_SOURCE) - 1};
  odo_plugin t = hostile::table();
  t.interfaces = &kind;
  t.activate = [](odo_instance*, const odo_sink* s) -> int32_t { return hostile::sink() = s, ODO_OK; };
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    static uint32_t motions = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
      if (batch->messages[i]->type != ODO_TYPE_VO_MOTION) continue;
      odo_vo_motion motion;
      odo_copy(&motion, sizeof motion, batch->messages[i]);
      odo_scale scale;
      std::memset(&scale, 0, sizeof scale);
      scale.header.struct_size = sizeof scale;
      scale.header.type = ODO_TYPE_SCALE;
      scale.header.t_ns = motion.header.t_ns;
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
