/* SPDX-License-Identifier: Apache-2.0
 *
 * All our plugins linked into one program: no symbol is defined twice, all ids are unique, and each can be registered.
 * linked_all.inc has PLUGIN(KIND_NAME) for each; the build writes it.
 */
#include <stdio.h>
#include <string.h>

#include <odograph/odograph.h>

#define PLUGIN(name) int32_t ODO_CALL odo_plugin_entry_##name(const struct odo_host* host, struct odo_plugin* out);
#include "linked_all.inc"
#undef PLUGIN

#define PLUGIN(name) {odo_plugin_entry_##name, #name},
static const struct {
  odo_plugin_entry entry;
  const char* name;
} plugins[] = {
#include "linked_all.inc"
};

int main(void) {
  size_t i;
  int failed = 0;
  for (i = 0; i < sizeof plugins / sizeof plugins[0]; ++i) {
    odo_error error = {.struct_size = sizeof error};
    if (odo_register_plugin(plugins[i].entry, &error) == ODO_OK) continue;
    printf("FAILED: %s: %s\n", plugins[i].name, error.message);
    failed = 1;
  }
  printf("%u plugins in one program\n", (unsigned)i);
  return failed;
}
