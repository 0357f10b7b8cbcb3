/* SPDX-License-Identifier: Apache-2.0
 *
 * Saved estimates of plugins, as a blob kept by the app. */
#include "app.h"

/* Each plugin saves its id and kind, and stores what it loads. */
static char loaded[256];
static size_t loads;
static int32_t load_status;
static uint64_t saved_size; /* 0: the text */

static int64_t save_text(probe_call* call) {
  char text[96];
  const int size = snprintf(text, sizeof text, "%s as %s;", call->instance->plugin, call->instance->kind);
  if (saved_size) {
    if (call->data && call->size >= saved_size) memset(call->data, 'x', (size_t)saved_size);
    return (int64_t)saved_size;
  }
  if (call->data && call->size >= (uint64_t)size) memcpy(call->data, text, (size_t)size);
  return size;
}

static int64_t on_call(probe_call* call) {
  if (call->what == PROBE_SAVE) return save_text(call);
  if (call->what != PROBE_LOAD) return ODO_OK;
  ++loads;
  if (strlen(loaded) + call->size < sizeof loaded) strncat(loaded, (const char*)call->blob, (size_t)call->size);
  return load_status;
}

typedef struct saved {
  unsigned char* bytes;
  int64_t size;
} saved;

static saved save_of(app* self) {
  saved blob = {NULL, odo.session_save(self->session, NULL, 0)};
  REQUIRE(blob.size > 0, "odo_session_save without memory = %s", status_name(blob.size));
  blob.bytes = (unsigned char*)malloc((size_t)blob.size + 8);
  memset(blob.bytes, 0xA5, (size_t)blob.size + 8);
  int64_t written = odo.session_save(self->session, blob.bytes, (uint64_t)blob.size - 1);
  EQUAL(written, blob.size);
  CHECK(blob.bytes[0] == 0xA5, "it wrote although the capacity does not suffice");
  written = odo.session_save(self->session, blob.bytes, (uint64_t)blob.size);
  CHECK(written == blob.size, "odo_session_save = %lld; expected %lld", (long long)written, (long long)blob.size);
  CHECK(blob.bytes[blob.size] == 0xA5, "it wrote behind the capacity");
  return blob;
}

static app* open_saving(const char* config) {
  hooks.on_call = on_call;
  return app_open(config, ODO_RUN_REPLAY);
}

CASE("what a plugin saved it is given to load", "odograph.h", "as a blob for") {
  const saved blob = save_of(open_saving(FIXER_ALONE));
  app* self = open_saving(FIXER_ALONE);
  EXPECT(odo.session_load(self->session, blob.bytes, (uint64_t)blob.size), ODO_OK);
  CHECK(strcmp(loaded, "conformance/probe as " FIXER ";") == 0, "the plugin was given \"%s\"", loaded);
}

CASE("each plugin is given its own part, those of absent plugins are ignored", "odograph.h",
     "Its parts are identified by plugin id; those of plugins that the config does not contain are ignored.") {
  const saved blob = save_of(open_saving(CONFIG WITH_ATTITUDE WITH_FRONTEND));
  app* self = open_saving(CONFIG WITH_FRONTEND);
  EXPECT(odo.session_load(self->session, blob.bytes, (uint64_t)blob.size), ODO_OK);
  CHECK(loads == 1 && strcmp(loaded, "conformance/frontend as " FRONTEND ";") == 0,
        "in %u calls plugins were given \"%s\"", (unsigned)loads, loaded);
}

CASE("another plugin of the same kind is not given the part", "plugin.h",
     "The host stores the state under the id of the plugin.") {
  const saved blob = save_of(open_saving(CONFIG WITH_ATTITUDE "vo_frontend:\n  plugin: conformance/frontend\n"));
  app* self = open_saving(CONFIG WITH_ATTITUDE "vo_frontend:\n  plugin: conformance/several\n");
  EXPECT(odo.session_load(self->session, blob.bytes, (uint64_t)blob.size), ODO_OK);
  CHECK(strcmp(loaded, "conformance/probe as " ATTITUDE ";") == 0, "plugins were given \"%s\"", loaded);
}

/* Each byte, one at a time. */
CASE("every damage of a saved blob is found before a plugin is given its part", "odograph.h",
     "ODO_E_DATA if the blob is damaged (nothing changes)") {
  const saved blob = save_of(open_saving(FIXER_ALONE));
  app* self = open_saving(FIXER_ALONE);
  int taken = 0;
  for (int64_t i = 0; i < blob.size; ++i) {
    int32_t status;
    blob.bytes[i] ^= 0x10;
    status = odo.session_load(self->session, blob.bytes, (uint64_t)blob.size);
    taken += status >= 0;
    CHECK(status < 0 || taken > 3, "with byte %lld changed odo_session_load = %s", (long long)i, status_name(status));
    CHECK(status >= 0 || status == ODO_E_DATA, "with byte %lld changed odo_session_load = %s", (long long)i,
          status_name(status));
    blob.bytes[i] ^= 0x10;
  }
  for (int64_t i = 0; i < blob.size; ++i) {
    const int32_t status = odo.session_load(self->session, blob.bytes, (uint64_t)i);
    CHECK(status == ODO_E_DATA, "cut to %lld bytes odo_session_load = %s", (long long)i, status_name(status));
  }
  EQUAL(loads, 0);
}

CASE("a plugin that refuses its part keeps it from nobody else", "odograph.h",
     "ODO_PARTIAL if a plugin rejects its part (the others are restored)") {
  const saved blob = save_of(open_saving(CONFIG WITH_ATTITUDE WITH_FRONTEND));
  app* self = open_saving(CONFIG WITH_ATTITUDE WITH_FRONTEND);
  load_status = ODO_E_DATA;
  EXPECT(odo.session_load(self->session, blob.bytes, (uint64_t)blob.size), ODO_PARTIAL);
  EQUAL(loads, 2);
}

CASE("saved state that is too large is left out and reported", "plugin.h",
     "bytes of saved state of one instance; more is reported, not saved") {
  saved_size = (uint64_t)ODO_LARGEST_STATE + 1;
  app* self = open_saving(FIXER_ALONE);
  int64_t size = odo.session_save(self->session, NULL, 0);
  CHECK(size >= 0 && size < 100000, "odo_session_save = %lld although the part is too large", (long long)size);
  app_flush(self);
  CHECK(app_events(self, ODO_TYPE_REPORT) >= 1, "nothing reports that the part was left out");
}

CASE("saving and loading null is refused", "base.h", "the call violates the contract") {
  app* self = open_saving(FIXER_ALONE);
  EXPECT(odo.session_load(self->session, NULL, 10), ODO_E_ARGUMENT);
  EXPECT(odo.session_save(self->session, NULL, 10), ODO_E_ARGUMENT);
  EXPECT(odo.session_load(NULL, "x", 1), ODO_E_ARGUMENT);
}
