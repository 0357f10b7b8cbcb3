// SPDX-License-Identifier: Apache-2.0
// A front-end that emits what it receives: the bytes behind the head of ODO_TYPE_VENDOR(0, 1) are an event.
#define HOSTILE_ID "test/echo"
#include <odograph/vo_frontend.h>

#include "tests/hostile/table.hpp"

static const odo_sink*& sink_of(odo_instance* it) { return *reinterpret_cast<const odo_sink**>(it); }

HOSTILE_PLUGIN {
  HOSTILE_SERVES(t, ODO_INTERFACE_VO_FRONTEND);
  static const uint32_t inputs[] = {ODO_TYPE_VENDOR(0, 1)};
  static const uint32_t outputs[] = {ODO_TYPE_ATTITUDE,
                                     ODO_TYPE_STEP,
                                     ODO_TYPE_MOTION_MODE,
                                     ODO_TYPE_SCALE,
                                     ODO_TYPE_FIX,
                                     ODO_TYPE_POSE,
                                     ODO_TYPE_IMU,
                                     ODO_TYPE_CORRECTION,
                                     ODO_TYPE_REPORT,
                                     0x5000u,
                                     ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2),
                                     ODO_TYPE_VENDOR(0, ODO_BORROWED)};
  t.inputs = inputs, t.input_count = 1;
  t.outputs = outputs, t.output_count = sizeof outputs / sizeof *outputs;
  t.create = [](const odo_host*, uint32_t, const odo_string*, odo_instance** made) -> int32_t {
    return *made = reinterpret_cast<odo_instance*>(new const odo_sink*(nullptr)), ODO_OK;
  };
  t.activate = [](odo_instance* it, const odo_sink* sink) -> int32_t { return sink_of(it) = sink, ODO_OK; };
  t.destroy = [](odo_instance* it) { delete &sink_of(it); };
  t.process = [](odo_instance* it, const odo_batch* batch) -> int32_t {
    const odo_header& told = *batch->messages[0];
    if (told.type != ODO_TYPE_VENDOR(0, 1) || told.struct_size < 2 * sizeof(odo_header)) return ODO_OK;
    alignas(8) unsigned char event[ODO_LARGEST_MESSAGE];
    const uint32_t size = told.struct_size - static_cast<uint32_t>(sizeof told);
    std::memcpy(event, &told + 1, size);
    std::memset(event + size, 0, sizeof event - size);
    sink_of(it)->emit(sink_of(it), reinterpret_cast<const odo_header*>(event));
    return ODO_OK;
  };
}
