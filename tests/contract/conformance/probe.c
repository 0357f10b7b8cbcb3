/* SPDX-License-Identifier: Apache-2.0
 *
 * Built into the suite, and once per variant as a shared library (PROBE_MODULE is then its number). */
#include "probe.h"

#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

#include <stdlib.h>
#include <string.h>

#define TEXT(literal) \
  { literal, sizeof(literal) - 1 }

static const odo_string kinds[] = {TEXT(ODO_INTERFACE_ATTITUDE), TEXT(ODO_INTERFACE_STEP_ESTIMATOR),
                                   TEXT(ODO_INTERFACE_VO_FRONTEND), TEXT(ODO_INTERFACE_SCALE_SOURCE),
                                   TEXT(ODO_INTERFACE_ABSOLUTE_FIXER)};
static const odo_string ids[PROBE_VARIANTS] = {TEXT("conformance/probe"), TEXT("conformance/frontend"),
                                               TEXT("conformance/several"), TEXT("conformance/bare")};
static const uint32_t inputs[] = {
    ODO_TYPE_IMU,         ODO_TYPE_MAGNETOMETER, ODO_TYPE_BAROMETER,   ODO_TYPE_GNSS,          ODO_TYPE_CALIBRATION,
    ODO_TYPE_IMU_NOISE,   ODO_TYPE_WAYPOINT,     ODO_TYPE_EARTH_FIELD, ODO_TYPE_PLATFORM_POSE, ODO_TYPE_RANGE,
    ODO_TYPE_SYSTEM_STEP, ODO_TYPE_FRAME,        PROBE_MESSAGE,        PROBE_BORROWED,         PROBE_NEWER_INPUT,
    PROBE_NEWER_BORROWED, ODO_TYPE_CORRECTION};
static const uint32_t outputs[] = {PROBE_EVENT};
static const odo_parameter parameters[] = {{.struct_size = sizeof(odo_parameter),
                                            .type = ODO_PARAMETER_INT,
                                            .name = TEXT("answer"),
                                            .unit = TEXT(""),
                                            .help = TEXT("A number."),
                                            .default_text = TEXT("42"),
                                            .max = 100},
                                           {.struct_size = sizeof(odo_parameter),
                                            .type = ODO_PARAMETER_STRING,
                                            .name = TEXT("word"),
                                            .unit = TEXT(""),
                                            .help = TEXT("A word."),
                                            .default_text = TEXT("none")}};

#if defined(PROBE_MODULE)
static probe_handler handler_of(const odo_host* host) {
  if (!host || !ODO_HAS(host, get_service) || !host->get_service) return 0;
  const probe_service* service = (const probe_service*)host->get_service(host, PROBE_SERVICE, sizeof PROBE_SERVICE - 1);
  return service ? service->called : 0;
}
#else
static probe_handler handler_of(const odo_host* host) { return probe_called; }
#endif

static int64_t forward(probe_call* call, uint32_t what, const odo_host* host) {
  const probe_handler handler = handler_of(host);
  call->what = what;
  return handler ? handler(call) : ODO_OK;
}

static int64_t of_instance(odo_instance* self, uint32_t what) {
  probe_call call = {.instance = self};
  return forward(&call, what, self->host);
}

static void copy_text(char* to, size_t capacity, const odo_string* from) {
  const size_t size = from->size < capacity - 1 ? (size_t)from->size : capacity - 1;
  memcpy(to, from->data, size);
  to[size] = 0;
}

static int32_t create(const odo_host* host, uint32_t number, const odo_string* kind, odo_instance** out, int variant) {
  odo_instance* self = (odo_instance*)calloc(1, sizeof *self);
  if (!self) return ODO_E_MEMORY;
  self->host = host;
  self->number = number;
  copy_text(self->plugin, sizeof self->plugin, &ids[variant]);
  copy_text(self->kind, sizeof self->kind, kind);
  int32_t status = (int32_t)of_instance(self, PROBE_CREATE);
  if (status < 0)
    free(self);
  else
    *out = self;
  return status;
}

static int32_t configure(odo_instance* self, const odo_value* values, uint32_t count, uint32_t stride) {
  probe_call call = {.instance = self, .values = values, .count = count, .size = stride};
  return (int32_t)forward(&call, PROBE_CONFIGURE, self->host);
}

static int32_t activate(odo_instance* self, const odo_sink* sink) {
  self->sink = sink;
  return (int32_t)of_instance(self, PROBE_ACTIVATE);
}

static int32_t process(odo_instance* self, const odo_batch* batch) {
  probe_call call = {.instance = self, .batch = batch};
  return (int32_t)forward(&call, PROBE_PROCESS, self->host);
}

static void destroy(odo_instance* self) {
  of_instance(self, PROBE_DESTROY);
  free(self);
}

static int32_t reset(odo_instance* self) { return (int32_t)of_instance(self, PROBE_RESET); }

static int64_t save(odo_instance* self, void* data, uint64_t capacity) {
  probe_call call = {.instance = self, .data = data, .size = capacity};
  return forward(&call, PROBE_SAVE, self->host);
}

static int32_t load(odo_instance* self, const void* data, uint64_t size) {
  probe_call call = {.instance = self, .blob = data, .size = size};
  return (int32_t)forward(&call, PROBE_LOAD, self->host);
}

static int32_t create_full(const odo_host* h, uint32_t n, const odo_string* k, odo_instance** o) {
  return create(h, n, k, o, PROBE_FULL);
}
static int32_t create_frontend(const odo_host* h, uint32_t n, const odo_string* k, odo_instance** o) {
  return create(h, n, k, o, PROBE_FRONTEND);
}
static int32_t create_several(const odo_host* h, uint32_t n, const odo_string* k, odo_instance** o) {
  return create(h, n, k, o, PROBE_SEVERAL);
}
static int32_t create_bare(const odo_host* h, uint32_t n, const odo_string* k, odo_instance** o) {
  return create(h, n, k, o, PROBE_BARE);
}

static void put_table(odo_plugin* table, int variant) {
  memset(table, 0, sizeof *table);
  table->struct_size = sizeof *table;
  table->abi_major = ODO_ABI_MAJOR, table->abi_minor = ODO_ABI_MINOR;
  table->interfaces = kinds, table->interface_count = sizeof kinds / sizeof *kinds;
  table->id = ids[variant];
  table->version.data = "1.0.0", table->version.size = 5;
  table->summary.data = "A plugin of the conformance suite.", table->summary.size = 34;
  table->parameters = parameters, table->parameter_count = sizeof parameters / sizeof *parameters;
  table->parameter_stride = sizeof *parameters;
  if (variant == PROBE_SEVERAL) table->flags = ODO_PLUGIN_SEVERAL_CAMERAS | ODO_PLUGIN_NATIVE_FRAMES;
  table->create = variant == PROBE_FULL       ? create_full
                  : variant == PROBE_FRONTEND ? create_frontend
                  : variant == PROBE_SEVERAL  ? create_several
                                              : create_bare;
  table->configure = configure, table->activate = activate, table->process = process, table->destroy = destroy;
  if (variant == PROBE_BARE) return;
  table->reset = reset, table->save = save, table->load = load;
  if (variant != PROBE_FULL) return;
  table->inputs = inputs, table->input_count = sizeof inputs / sizeof *inputs;
  table->outputs = outputs, table->output_count = sizeof outputs / sizeof *outputs;
}

static int32_t enter(const odo_host* host, odo_plugin* out, int variant) {
  odo_plugin table;
  if (!host || !out) return ODO_E_ARGUMENT;
  if (!ODO_HOST_FITS(host)) return ODO_E_VERSION;
  probe_call call = {.host = host, .data = out};
  forward(&call, PROBE_ENTRY, host);
  put_table(&table, variant);
  const uint32_t size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size;
  memcpy(out, &table, size);
  out->struct_size = size;
  return ODO_OK;
}

#if defined(PROBE_MODULE)
int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) { return enter(host, out, PROBE_MODULE); }
#else
static int32_t enter_full(const odo_host* host, odo_plugin* out) { return enter(host, out, PROBE_FULL); }
static int32_t enter_frontend(const odo_host* host, odo_plugin* out) { return enter(host, out, PROBE_FRONTEND); }
static int32_t enter_several(const odo_host* host, odo_plugin* out) { return enter(host, out, PROBE_SEVERAL); }
static int32_t enter_bare(const odo_host* host, odo_plugin* out) { return enter(host, out, PROBE_BARE); }
const odo_plugin_entry probe_entries[PROBE_VARIANTS] = {enter_full, enter_frontend, enter_several, enter_bare};
#endif
