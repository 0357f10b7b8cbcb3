// SPDX-License-Identifier: Apache-2.0
//
// The plugins of samples/configs/walk.yaml, which are linked into odograph.wasm, and the memory they ask for.
#include <cstdlib>
#include <initializer_list>
#include <new>

#include <odograph/odograph.h>

extern "C" {
int32_t odo_plugin_entry_attitude_vqf(const odo_host* host, odo_plugin* out);
int32_t odo_plugin_entry_step_odograph(const odo_host* host, odo_plugin* out);
int32_t odo_plugin_entry_vo_odograph(const odo_host* host, odo_plugin* out);
int32_t odo_plugin_entry_surface_planes(const odo_host* host, odo_plugin* out);

int32_t odo_web_register(odo_error* error) {
  for (const odo_plugin_entry entry : {odo_plugin_entry_attitude_vqf, odo_plugin_entry_step_odograph,
                                       odo_plugin_entry_vo_odograph, odo_plugin_entry_surface_planes})
    if (const int32_t status = odo_register_plugin(entry, error); status < 0) return status;
  return ODO_OK;
}
}

// In steps of 16 bytes, not of emscripten's 8: Eigen sums what lies on such a step in other pairs than what does not,
// and a session's numbers are not to depend on where its memory lies.
void* operator new(size_t size) {
  void* memory = nullptr;
  if (posix_memalign(&memory, 16, size ? size : 1) != 0) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
