/* SPDX-License-Identifier: Apache-2.0 */
#include "app.h"

static const void* ODO_CALL app_service(void* user, const char* id, uint64_t size) {
  static const probe_service service = {sizeof(probe_service), 0, probe_called};
  return size == sizeof PROBE_SERVICE - 1 && memcmp(id, PROBE_SERVICE, size) == 0 ? &service : NULL;
}

void need_plugins(void) {
  static bool registered;
  odo_error error = {sizeof error, 0, ""};
  if (registered) return;
  registered = true;
  if (!strstr(library_missing(), "odo_register_plugin") && !options.by_folder) {
    for (int i = 0; i < PROBE_VARIANTS; ++i)
      if (odo.register_plugin(probe_entries[i], &error) != ODO_OK)
        stop_at(__FILE__, __LINE__, "the suite's plugin %d was not registered: %s", i, error.message);
  } else if (!options.plugin_folder) {
    skip_case("the library has no odo_register_plugin, and no folder of plugins was given");
  }
}

odo_session_options app_options(const char* config, uint32_t run) {
  odo_session_options chosen = {.struct_size = sizeof chosen};
  chosen.run = run;
  chosen.config_text = string_of(config);
  if (options.plugin_folder) chosen.plugin_path = string_of(options.plugin_folder);
  chosen.get_service = app_service;
  return chosen;
}

static void ODO_CALL on_event(void* user, const odo_header* event) {
  app* self = (app*)user;
  odo_header* copy = (odo_header*)malloc(event->struct_size);
  memcpy(copy, event, event->struct_size);
  pthread_mutex_lock(&self->lock);
  if (self->count == self->capacity) {
    self->capacity = self->capacity ? 2 * self->capacity : 256;
    self->events = (odo_header**)realloc(self->events, self->capacity * sizeof(odo_header*));
  }
  self->events[self->count++] = copy;
  self->callback_thread = pthread_self();
  pthread_mutex_unlock(&self->lock);
  if (self->on_event) self->on_event(self, event);
}

app* app_open_options(const odo_session_options* chosen) {
  app* self = (app*)calloc(1, sizeof *self);
  odo_error error = {sizeof error, 0, ""};
  need_plugins();
  pthread_mutex_init(&self->lock, NULL);
  int32_t status = odo.session_create(chosen, &self->session, &error);
  REQUIRE(status == ODO_OK && self->session, "odo_session_create = %s: %s", status_name(status), error.message);
  EXPECT(odo.session_set_callback(self->session, NULL, ODO_ALL_EVENTS, on_event, self), ODO_OK);
  return self;
}

app* app_open(const char* config, uint32_t run) {
  const odo_session_options chosen = app_options(config, run);
  return app_open_options(&chosen);
}

void app_close(app* self) {
  odo.session_destroy(self->session);
  self->session = NULL;
}

const odo_header* app_event(app* self, uint32_t type, size_t index) {
  const odo_header* found = NULL;
  pthread_mutex_lock(&self->lock);
  for (size_t i = 0; i < self->count && !found; ++i)
    if (self->events[i]->type == type && index-- == 0) found = self->events[i];
  pthread_mutex_unlock(&self->lock);
  return found;
}

size_t app_events(app* self, uint32_t type) {
  size_t count = 0;
  pthread_mutex_lock(&self->lock);
  for (size_t i = 0; i < self->count; ++i) count += self->events[i]->type == type;
  pthread_mutex_unlock(&self->lock);
  return count;
}

bool app_reported(app* self, const char* key_or_text) {
  const odo_header* event;
  for (size_t i = 0; (event = app_event(self, ODO_TYPE_REPORT, i)) != NULL; ++i) {
    const odo_report* report = (const odo_report*)(const void*)event;
    if (strcmp(report->key, key_or_text) == 0 || strstr(report->text, key_or_text)) return true;
  }
  return false;
}

odo_statistics app_statistics(app* self) {
  odo_statistics statistics = {.struct_size = sizeof statistics};
  EXPECT(odo.session_get_statistics(self->session, &statistics), ODO_OK);
  return statistics;
}

void app_flush(app* self) { EXPECT(odo.session_flush(self->session), ODO_OK); }

bool app_wait_events(app* self, uint32_t type, size_t count) {
  for (int i = 0; i < 500 && app_events(self, type) < count; ++i) sleep_ms(10);
  return app_events(self, type) >= count;
}
