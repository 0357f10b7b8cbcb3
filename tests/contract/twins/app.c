/* SPDX-License-Identifier: Apache-2.0
 *
 * Calls two plugins with the same class name by their entries, linked (ODO_STATIC) or loaded from the two given files,
 * and checks that each has its own id, default and process. */
#include <stdio.h>
#include <string.h>

#include <odograph/attitude.h>
#include <odograph/messages.h>

#if defined(ODO_STATIC)
int32_t ODO_CALL twin_entry_1(const odo_host* host, odo_plugin* out);
int32_t ODO_CALL twin_entry_2(const odo_host* host, odo_plugin* out);
#else
#include <dlfcn.h>
#endif

static double emitted;

static int32_t ODO_CALL emit(const odo_sink* sink, const odo_header* event) {
  (void)sink;
  emitted = ((const odo_attitude*)(const void*)event)->gyro_bias_b[0];
  return ODO_OK;
}

static const void* ODO_CALL get_service(const odo_host* host, const char* id, uint64_t id_size) {
  (void)host, (void)id, (void)id_size;
  return NULL;
}

/* What process of a new instance emits. */
static double run(const odo_host* host, const odo_plugin* table) {
  odo_instance* instance = NULL;
  odo_imu imu;
  odo_sink sink;
  odo_batch batch;
  const odo_header* messages[1];
  memset(&imu, 0, sizeof imu), memset(&sink, 0, sizeof sink), memset(&batch, 0, sizeof batch);
  imu.header.struct_size = sizeof imu, imu.header.type = ODO_TYPE_IMU, imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
  sink.struct_size = sizeof sink, sink.emit = emit;
  messages[0] = &imu.header;
  batch.struct_size = sizeof batch, batch.count = 1, batch.messages = messages;
  emitted = 0;
  if (table->create(host, 1, table->interfaces, &instance) != ODO_OK) return -1;
  if (table->configure(instance, NULL, 0, sizeof(odo_value)) != ODO_OK || table->activate(instance, &sink) != ODO_OK)
    return -2;
  if (table->process(instance, &batch) != ODO_OK) return -3;
  table->destroy(instance);
  return emitted;
}

int main(int argc, char** argv) {
  static const char* const ids[2] = {"twin/one", "twin/two"};
  odo_plugin_entry entries[2] = {NULL, NULL};
  odo_plugin tables[2];
  odo_host host;
  int wrong = 0;
  memset(&host, 0, sizeof host), memset(tables, 0, sizeof tables);
  host.struct_size = sizeof host, host.abi_minor = ODO_ABI_MINOR, host.get_service = get_service;
  host.abi_major_min = host.abi_major_max = ODO_ABI_MAJOR;
#if defined(ODO_STATIC)
  (void)argc, (void)argv;
  entries[0] = twin_entry_1, entries[1] = twin_entry_2;
#else
  for (int i = 0; i < 2 && argc == 3; ++i) {
    void* library = dlopen(argv[i + 1], RTLD_NOW | RTLD_LOCAL);
    if (library) *(void**)(&entries[i]) = dlsym(library, ODO_PLUGIN_ENTRY_SYMBOL);
  }
#endif
  for (int i = 0; i < 2; ++i) {
    tables[i].struct_size = sizeof tables[i];
    if (!entries[i] || entries[i](&host, &tables[i]) != ODO_OK) return puts("an entry is missing or refuses"), 1;
  }
  for (int i = 0; i < 2; ++i) {
    const double gain = run(&host, &tables[i]);
    const int is_own = tables[i].id.size == strlen(ids[i]) && memcmp(tables[i].id.data, ids[i], tables[i].id.size) == 0;
    if (is_own && gain == i + 1) continue;
    printf("plugin %d has the id %.*s and emits %g\n", i + 1, (int)tables[i].id.size, tables[i].id.data, gain);
    wrong = 1;
  }
  return wrong;
}
