// SPDX-License-Identifier: Apache-2.0
// Emits invalid events: NaN, another kind's event, an event that is too small, null, and far too many.
#include <limits>

#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  odo_plugin t = hostile::table();
  t.process = [](odo_instance*, const odo_batch*) -> int32_t {
    const odo_sink* sink = hostile::sink();
    odo_scale scale;
    std::memset(&scale, 0, sizeof scale);
    scale.header.struct_size = sizeof scale;
    scale.header.type = ODO_TYPE_SCALE;
    scale.scale = std::numeric_limits<double>::quiet_NaN();
    sink->emit(sink, &scale.header);
    scale.scale = 1.0;
    scale.header.struct_size = 40;
    sink->emit(sink, &scale.header);
    scale.header.struct_size = sizeof scale;
    scale.header.type = ODO_TYPE_POSE;
    sink->emit(sink, &scale.header);
    sink->emit(sink, nullptr);
    scale.header.type = ODO_TYPE_SCALE;
    for (int i = 0; i < 1000; ++i) sink->emit(sink, &scale.header);
    return ODO_OK;
  };
  return hostile::fill(out, t);
}
