// SPDX-License-Identifier: Apache-2.0
// A good fixer that uses a vendor's messages, and answers with one as well.
#define HOSTILE_ID "test/wifi_fixer"
#include <odograph/absolute_fixer.h>

#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string interfaces[] = {{ODO_INTERFACE_ABSOLUTE_FIXER, sizeof(ODO_INTERFACE_ABSOLUTE_FIXER) - 1}};
  static const uint32_t inputs[] = {ODO_TYPE_VENDOR(7, 1)}, outputs[] = {ODO_TYPE_VENDOR(7, ODO_VENDOR_EVENT | 2)};
  odo_plugin t = hostile::table();
  t.interfaces = interfaces;
  t.inputs = inputs, t.outputs = outputs;
  t.input_count = t.output_count = 1;
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    for (uint32_t i = 0; i < batch->count; ++i) {
      const odo_header& message = *batch->messages[i];
      if (message.type != ODO_TYPE_VENDOR(7, 1)) continue;
      auto fix = hostile::make<odo_fix>(ODO_TYPE_FIX, message.t_ns);
      fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
      fix.p_n[0] = message.struct_size;
      fix.covariance_n[0] = fix.covariance_n[4] = fix.covariance_n[8] = 1;
      odo_header answer = {};
      answer.struct_size = sizeof answer;
      answer.type = ODO_TYPE_VENDOR(7, ODO_VENDOR_EVENT | 2);
      answer.t_ns = message.t_ns;
      if (hostile::sink()->emit(hostile::sink(), &fix.header) < 0) return ODO_E_ERROR;
      if (hostile::sink()->emit(hostile::sink(), &answer) < 0) return ODO_E_ERROR;
    }
    return ODO_OK;
  };
  return hostile::fill(out, t);
}
