// SPDX-License-Identifier: Apache-2.0
// A front-end that reports its inputs: ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2) with the message behind the head. It
// also declares its own events as inputs, which it must not receive.
#define HOSTILE_ID "test/listens"
#include <odograph/vo_frontend.h>

#include "tests/hostile/table.hpp"

HOSTILE_PLUGIN {
  HOSTILE_SERVES(t, ODO_INTERFACE_VO_FRONTEND);
  static const uint32_t types[] = {ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2)};
  t.inputs = t.outputs = types, t.input_count = t.output_count = 1;
  t.flags = ODO_PLUGIN_SEVERAL_CAMERAS;
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    const odo_header& told = *batch->messages[0];
    if (told.type == ODO_TYPE_IMU || told.type == ODO_TYPE_ATTITUDE) return ODO_OK;
    alignas(8) static unsigned char event[ODO_LARGEST_MESSAGE];
    auto& head = *reinterpret_cast<odo_header*>(event);
    head = told;
    head.type = ODO_TYPE_VENDOR(0, ODO_VENDOR_EVENT | 2),
    head.struct_size = static_cast<uint32_t>(sizeof head) + told.struct_size;
    std::memcpy(event + sizeof head, &told, told.struct_size);
    hostile::emit(head);
    return ODO_OK;
  };
}
