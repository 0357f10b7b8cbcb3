// SPDX-License-Identifier: Apache-2.0
//
// The plugins of samples/configs/walk.yaml, which are linked into odograph.wasm.
#include <initializer_list>

#include <odograph/odograph.h>

extern "C" {
int32_t odo_plugin_entry_attitude_vqf(const odo_host* host, odo_plugin* out);
int32_t odo_plugin_entry_step_odograph(const odo_host* host, odo_plugin* out);
int32_t odo_plugin_entry_vo_odograph(const odo_host* host, odo_plugin* out);

int32_t odo_web_register(odo_error* error) {
  for (const odo_plugin_entry entry :
       {odo_plugin_entry_attitude_vqf, odo_plugin_entry_step_odograph, odo_plugin_entry_vo_odograph})
    if (const int32_t status = odo_register_plugin(entry, error); status < 0) return status;
  return ODO_OK;
}
}
