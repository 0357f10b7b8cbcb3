/* SPDX-License-Identifier: Apache-2.0
 *
 * An attitude that declares every input and emits every event that a plugin may emit, for app.c: in
 * response to a QUESTION it emits one of each, and an ANSWER with its inputs so far. Also a front-end, which says
 * nothing, and a surface finder, which answers with a surface. */
#include <stdlib.h>

#include <odograph/attitude.h>
#include <odograph/surface_finder.h>
#include <odograph/vo_frontend.h>

#include "every.h"

struct odo_instance {
  const odo_host* host;
  const odo_sink* sink;
  uint32_t number;
  int finds_surfaces, is_attitude;
  struct answer answer;
  char map[64]; /* what has come of one */
  uint64_t map_size;
};

/* A saved state or map. */
struct state {
  char magic[8];
  double value;
#ifdef ODO_TEST_GROWN
  double later;
#endif
};

static const odo_string kinds[] = {{ODO_INTERFACE_ATTITUDE, sizeof ODO_INTERFACE_ATTITUDE - 1},
                                   {ODO_INTERFACE_VO_FRONTEND, sizeof ODO_INTERFACE_VO_FRONTEND - 1},
                                   {ODO_INTERFACE_SURFACE_FINDER, sizeof ODO_INTERFACE_SURFACE_FINDER - 1}};

static int is_kind(const odo_string* kind, int i) {
  return kind->size == kinds[i].size && memcmp(kind->data, kinds[i].data, (size_t)kind->size) == 0;
}

static int32_t ODO_CALL create(const odo_host* host, uint32_t number, const odo_string* kind, odo_instance** out) {
  *out = (odo_instance*)calloc(1, sizeof **out);
  if (!*out) return ODO_E_MEMORY;
  (*out)->host = host, (*out)->number = number;
  (*out)->is_attitude = is_kind(kind, 0), (*out)->finds_surfaces = is_kind(kind, 2);
  for (uint32_t i = 0; i < MAX_ROWS; ++i) (*out)->answer.grown[i] = -2;
  return ODO_OK;
}

static int32_t ODO_CALL configure(odo_instance* self, const odo_value* values, uint32_t count, uint32_t stride) {
  (void)self;
  return count == 1 && stride >= ODO_VALUE_SIZE_MIN && values->integer == 42 ? ODO_OK : ODO_E_CONFIG;
}

static const void* service(const odo_instance* self, const char* id) {
  const uint32_t* table = (const uint32_t*)self->host->get_service(self->host, id, strlen(id));
  return table && *table >= 16 ? table : NULL;
}

static int32_t ODO_CALL activate(odo_instance* self, const odo_sink* sink) {
  static const char* const ids[] = {ODO_SERVICE_REPORT, ODO_SERVICE_RANDOM, ODO_SERVICE_ASSETS, ODO_SERVICE_CONTENTS,
                                    ODO_SERVICE_WAKE};
  const odo_report_service* report = (const odo_report_service*)service(self, ODO_SERVICE_REPORT);
  const odo_random_service* random = (const odo_random_service*)service(self, ODO_SERVICE_RANDOM);
  const odo_string key = {"every", 5}, text = {"a report", 8};
  uint32_t found = 0;
  self->sink = sink;
  for (uint32_t i = 0; i < 5; ++i) found |= (service(self, ids[i]) != NULL) << i;
  self->answer.services = found;
  if (random) self->answer.seed = (double)(random->seed(self->host, self->number, 3) % 100000);
  if (report) report->report(self->host, self->number, ODO_SEVERITY_INFO, &key, &text);
  return ODO_OK;
}

static const uint32_t events[] = {ODO_TYPE_STEP,    ODO_TYPE_MOTION_MODE, ODO_TYPE_POINTS,  ODO_TYPE_VO_MOTION,
                                  ODO_TYPE_SCALE,   ODO_TYPE_FIX,         ODO_TYPE_REFINED, ODO_TYPE_RELATIVE_POSE,
                                  ODO_TYPE_SURFACE, ODO_TYPE_KEY_FRAME,   ODO_TYPE_MAP_POSE};

static int32_t answer(odo_instance* self, int64_t t_ns) {
  union message event;
  for (size_t i = 0; i < sizeof events / sizeof *events; ++i) {
    fill(&event, events[i], t_ns);
    if (self->sink->emit(self->sink, &event.header) < 0) return ODO_E_ERROR;
  }
  self->answer.header.struct_size = sizeof self->answer, self->answer.header.type = ANSWER,
  self->answer.header.t_ns = t_ns;
  return self->sink->emit(self->sink, &self->answer.header);
}

static int32_t find_surface(odo_instance* self, const odo_batch* batch) {
  for (uint32_t i = 0; i < batch->count; ++i) {
    union message surface;
    if (batch->messages[i]->type != QUESTION) continue;
    fill(&surface, ODO_TYPE_SURFACE, batch->messages[i]->t_ns);
    if (self->sink->emit(self->sink, &surface.header) < 0) return ODO_E_ERROR;
  }
  return ODO_OK;
}

static int32_t ODO_CALL process(odo_instance* self, const odo_batch* batch) {
  if (self->finds_surfaces) return find_surface(self, batch);
  if (!self->is_attitude) return ODO_OK;
  for (uint32_t i = 0; i < batch->count; ++i) {
    const odo_header* message = batch->messages[i];
    const uint32_t row = row_of(message->type);
    union message attitude;
    if (message->type == LARGE) self->answer.large_size = message->struct_size;
    if (message->type == QUESTION && answer(self, message->t_ns) < 0) return ODO_E_ERROR;
    if (row < MAX_ROWS && message->type != QUESTION) self->answer.grown[row] = grown_of(message);
    if (message->type != ODO_TYPE_IMU) continue;
    fill(&attitude, ODO_TYPE_ATTITUDE, message->t_ns);
    if (self->sink->emit(self->sink, &attitude.header) < 0) return ODO_E_ERROR;
  }
  return ODO_OK;
}

static void ODO_CALL destroy(odo_instance* self) { free(self); }

static void fill_state(struct state* state) {
  memset(state, 0, sizeof *state);
  memcpy(state->magic, "EVERY", 6), state->value = 7;
#ifdef ODO_TEST_GROWN
  state->later = 8;
#endif
}

static int64_t ODO_CALL save(odo_instance* self, void* data, uint64_t capacity) {
  struct state state;
  fill_state(&state);
  (void)self;
  if (capacity >= sizeof state) memcpy(data, &state, sizeof state);
  return sizeof state;
}

static int32_t read_state(const void* data, uint64_t size, double* value) {
  const uint64_t of_first_version = 16;
  if (size < of_first_version || memcmp(data, "EVERY", 6) != 0) return ODO_E_DATA;
  memcpy(value, (const char*)data + 8, 8);
  return ODO_OK;
}

static int32_t ODO_CALL load(odo_instance* self, const void* data, uint64_t size) {
  return read_state(data, size, &self->answer.state);
}

/* In pieces of at most ten bytes. */
static int64_t ODO_CALL save_map(odo_instance* self, uint64_t offset, void* data, uint64_t capacity) {
  struct state map;
  uint64_t size = offset < sizeof map ? sizeof map - offset : 0;
  fill_state(&map);
  (void)self;
  if (size > 10) size = 10;
  if (size > capacity) size = capacity;
  if (size > 0) memcpy(data, (const char*)&map + offset, (size_t)size);
  return (int64_t)size;
}

static int32_t ODO_CALL load_map(odo_instance* self, uint64_t offset, const void* data, uint64_t size) {
  if (size == 0) return read_state(self->map, self->map_size, &self->answer.map);
  if (offset > sizeof self->map || size > sizeof self->map - offset) return ODO_E_DATA;
  memcpy(self->map + offset, data, (size_t)size);
  self->map_size = offset + size;
  return ODO_OK;
}

ODO_EXPORT int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  static uint32_t inputs[MAX_ROWS] = {QUESTION, LARGE}, outputs[MAX_ROWS] = {ANSWER};
  static odo_parameter row;
  odo_plugin table;
  uint32_t size, count = 2;
  if (!host || !out || out->struct_size < ODO_PLUGIN_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  memset(&row, 0, sizeof row), memset(&table, 0, sizeof table);
  row.struct_size = sizeof row, row.type = ODO_PARAMETER_INT, row.max = 100;
  row.name.data = "answer", row.name.size = 6, row.help.data = "The answer.", row.help.size = 11;
  row.default_text.data = "42", row.default_text.size = 2;
#define ROW(number, type, name, min_size) \
  if (!ODO_IS_EVENT(number) && number != ODO_TYPE_IMU) inputs[count++] = number;
  ODO_FOR_EACH_MESSAGE(ROW)
#undef ROW
  memcpy(outputs + 1, events, sizeof events);
  table.struct_size = sizeof table;
  table.abi_major = ODO_ABI_MAJOR, table.abi_minor = ODO_ABI_MINOR;
  table.interfaces = kinds, table.interface_count = sizeof kinds / sizeof *kinds;
  table.id.data = "test/every", table.id.size = 10, table.version.data = "1.0.0", table.version.size = 5;
  table.summary.data = "For a test.", table.summary.size = 11;
  table.parameters = &row, table.parameter_count = 1, table.parameter_stride = sizeof row;
  table.inputs = inputs, table.input_count = count;
  table.outputs = outputs, table.output_count = 1 + sizeof events / sizeof *events;
  table.create = create, table.configure = configure, table.activate = activate;
  table.process = process, table.destroy = destroy, table.save = save, table.load = load;
  table.save_map = save_map, table.load_map = load_map;
  size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size;
  memcpy(out, &table, size);
  out->struct_size = size;
  return ODO_OK;
}
