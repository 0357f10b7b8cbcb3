/* SPDX-License-Identifier: Apache-2.0
 *
 * The host's services for plugins, by id. */
#include "app.h"

#define SERVICE(from, id) ((from)->get_service((from), (id), strlen(id)))

static const odo_host* host_at_create;
static const void* found[8];

static int64_t ask_for(const odo_host* host) {
  static const char* const ids[] = {ODO_SERVICE_REPORT, ODO_SERVICE_RANDOM, ODO_SERVICE_ASSETS, ODO_SERVICE_CONTENTS,
                                    ODO_SERVICE_WAKE,   "odo.nothing/1",    "acme.java_vm/1",   ""};
  host_at_create = host;
  for (size_t i = 0; i < COUNT_OF(ids); ++i) found[i] = SERVICE(host, ids[i]);
  return ODO_OK;
}

static int64_t ask_at_create(probe_call* call) {
  return call->what == PROBE_CREATE ? ask_for(call->instance->host) : ODO_OK;
}

static uint64_t apps_table[4] = {sizeof apps_table};
static const void* ODO_CALL app_service(void* user, const char* id, uint64_t size) {
  if (size == sizeof PROBE_SERVICE - 1 && memcmp(id, PROBE_SERVICE, size) == 0) {
    const odo_session_options by_suite = app_options("", ODO_RUN_REPLAY);
    return by_suite.get_service(NULL, id, size);
  }
  return user == apps_table && size == 14 && memcmp(id, "acme.java_vm/1", 14) == 0 ? apps_table : NULL;
}

CASE("the host's services are there and have their sizes", "plugin.h",
     "Returns the table of a service, or null if it is not available; a plugin must work without it.") {
  static const uint32_t sizes[] = {ODO_REPORT_SERVICE_SIZE_MIN, ODO_RANDOM_SERVICE_SIZE_MIN, ODO_ASSET_SERVICE_SIZE_MIN,
                                   ODO_ASSET_SERVICE_2_SIZE_MIN, ODO_WAKE_SERVICE_SIZE_MIN};
  hooks.on_call = ask_at_create;
  app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  REQUIRE(host_at_create, "no instance was made");
  for (size_t i = 0; i < COUNT_OF(sizes); ++i) {
    uint32_t size = 0;
    CHECK(found[i], "service %u of the host is missing", (unsigned)i);
    if (found[i]) memcpy(&size, found[i], sizeof size);
    CHECK(!found[i] || size >= sizes[i], "service %u has %u bytes; expected %u at least", (unsigned)i, size, sizes[i]);
  }
  CHECK(!found[5] && !found[7], "there is a table for an id that nobody offers");
  CHECK(!found[6], "there is a table for an id of the app's, which offers none");
}

CASE("the app's services reach plugins, but not for the host's ids", "plugin.h",
     "The host provides the ids that start with \"odo.\"; it passes all others to the app "
     "(odo_session_options.get_service).") {
  odo_session_options chosen = app_options(FIXER_ALONE, ODO_RUN_REPLAY);
  hooks.on_call = ask_at_create;
  chosen.get_service = app_service;
  chosen.user = apps_table;
  app_open_options(&chosen);
  CHECK(found[6] == apps_table, "the plugin was not given the app's table");
  CHECK(!found[5], "an id that begins with \"odo.\" was answered");
}

/* ---- reports ---- */
static int32_t report_thrice(odo_instance* instance, const odo_header* message) {
  const odo_report_service* service = (const odo_report_service*)SERVICE(instance->host, ODO_SERVICE_REPORT);
  const odo_string key = string_of("trouble"), text = string_of("the lens is covered");
  if (message->type != ODO_TYPE_BAROMETER) return ODO_OK;
  for (int i = 0; service && i < 3; ++i)
    service->report(instance->host, instance->number, ODO_SEVERITY_WARNING, &key, &text);
  return ODO_OK;
}

CASE("a plugin's report is an event, once a second, with its count", "events.h",
     "The rate is limited to one report per second for each origin and key; `count` includes the suppressed ones.") {
  hooks.on_message = report_thrice;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  FLUSHED(self, push_barometer(self, T0));
  REQUIRE(app_events(self, ODO_TYPE_REPORT) == 1, "%u reports of one key came in a moment; expected 1",
          (unsigned)app_events(self, ODO_TYPE_REPORT));
  const odo_report* report = (const odo_report*)(const void*)app_event(self, ODO_TYPE_REPORT, 0);
  CHECK(strcmp(report->plugin, "conformance/probe") == 0 && strcmp(report->key, "trouble") == 0 &&
            strstr(report->text, "the lens is covered"),
        "it has plugin \"%s\", key \"%s\" and text \"%s\"", report->plugin, report->key, report->text);
  CHECK(report->severity == ODO_SEVERITY_WARNING && report->count == 1, "it has severity %u and count %llu",
        report->severity, (unsigned long long)report->count);
  EQUAL(report->header.source, journal_find(PROBE_CREATE, FIXER, 0)->number);
  sleep_ms(1100);
  FLUSHED(self, push_barometer(self, T0 + SECOND));
  report = (const odo_report*)(const void*)app_event(self, ODO_TYPE_REPORT, 1);
  REQUIRE(report, "a second later there was no report");
  EQUAL(report->count, 3);
}

/* ---- random numbers ---- */
static uint64_t seeds[4];

static int64_t draw(probe_call* call) {
  if (call->what != PROBE_ACTIVATE) return ODO_OK;
  const odo_random_service* service = (const odo_random_service*)SERVICE(call->instance->host, ODO_SERVICE_RANDOM);
  for (uint64_t i = 0; service && i < 2; ++i) seeds[i] = service->seed(call->instance->host, call->instance->number, i);
  if (service) seeds[2] = service->seed(call->instance->host, call->instance->number + 1, 0);
  if (service) seeds[3] = service->seed(call->instance->host, call->instance->number, 0);
  return ODO_OK;
}

static void draw_with(uint64_t seed, uint64_t out[4]) {
  odo_session_options chosen = app_options(FIXER_ALONE, ODO_RUN_REPLAY);
  chosen.seed = seed;
  app_close(app_open_options(&chosen));
  memcpy(out, seeds, sizeof seeds);
}

CASE("random seeds are a function of seed, instance and stream", "plugin.h",
     "Reproducible random seeds: a function of the seed of the run, the instance and the stream only.") {
  uint64_t one[4], same[4], other[4];
  hooks.on_call = draw;
  draw_with(1, one), draw_with(1, same), draw_with(2, other);
  CHECK(memcmp(one, same, sizeof one) == 0, "two sessions of one seed differ");
  CHECK(one[0] == one[3], "two calls with the same arguments differ");
  CHECK(one[0] != one[1] && one[0] != one[2], "streams or instances have the same seed");
  CHECK(one[0] != other[0], "two seeds give the same");
}

/* ---- assets ---- */
static struct {
  int64_t resolved, missing, read, behind;
  int32_t opened, not_opened;
  uint64_t size;
  bool has_contents;
  char path[512], data[16];
} assets;

static int64_t use_assets(probe_call* call) {
  const odo_string name = string_of("asset.txt"), nowhere = string_of("nowhere.txt");
  odo_asset* asset = NULL;
  if (call->what != PROBE_CONFIGURE) return ODO_OK;
  const odo_host* host = call->instance->host;
  const odo_asset_service* paths = (const odo_asset_service*)SERVICE(host, ODO_SERVICE_ASSETS);
  const odo_content_service* contents = (const odo_content_service*)SERVICE(host, ODO_SERVICE_CONTENTS);
  if (paths) {
    assets.resolved = paths->resolve(host, &name, assets.path, sizeof assets.path);
    assets.missing = paths->resolve(host, &nowhere, assets.path + 256, 256);
  }
  assets.has_contents = contents != NULL;
  if (!contents) return ODO_OK;
  assets.not_opened = contents->open(contents->user, &nowhere, &asset, &assets.size);
  assets.opened = contents->open(contents->user, &name, &asset, &assets.size);
  if (assets.opened != ODO_OK) return ODO_OK;
  assets.read = contents->read(asset, 2, assets.data, sizeof assets.data);
  assets.behind = contents->read(asset, 5, assets.data + 8, 8);
  contents->close(asset);
  return ODO_OK;
}

CASE("assets are found by path and by contents", "plugin.h", "Contents of files that a config names.") {
  const char* path = case_file("asset.txt");
  FILE* file = fopen(path, "wb");
  REQUIRE(file && fwrite("hello", 1, 5, file) == 5, "no file could be written");
  fclose(file);
  hooks.on_call = use_assets;
  odo_session_options chosen = app_options(FIXER_ALONE, ODO_RUN_REPLAY);
  chosen.asset_path = string_of(case_file(""));
  app_open_options(&chosen);
  CHECK(assets.resolved > 9 && assets.path[0] == '/' && strstr(assets.path, "asset.txt"),
        "odo.assets/1 resolved %lld: \"%.200s\"", (long long)assets.resolved, assets.path);
  EXPECT(assets.missing, ODO_E_NOT_FOUND);
  if (!assets.has_contents) skip_case("the host has no odo.contents/1");
  EXPECT(assets.not_opened, ODO_E_NOT_FOUND);
  CHECK(assets.opened == ODO_OK && assets.size == 5, "odo.contents/1 open = %s, size %llu", status_name(assets.opened),
        (unsigned long long)assets.size);
  CHECK(assets.read == 3 && memcmp(assets.data, "llo", 3) == 0, "odo.contents/1 read %lld bytes; expected 3",
        (long long)assets.read);
  EQUAL(assets.behind, 0);
}

/* ---- wake ---- */
static odo_instance* waker;
static int empty_batches, events_of_wake;

static int64_t note_empty(probe_call* call) {
  odo_header event;
  if (call->what == PROBE_ACTIVATE) waker = call->instance;
  if (call->what != PROBE_PROCESS || call->batch->count > 0) return ODO_OK;
  ++empty_batches;
  put_header(&event, sizeof event, PROBE_EVENT, T0);
  events_of_wake += probe_emit(call->instance, &event) == ODO_OK;
  return ODO_OK;
}

static void* wake_many(void* unused) {
  const odo_wake_service* service = (const odo_wake_service*)SERVICE(waker->host, ODO_SERVICE_WAKE);
  for (int i = 0; i < 10; ++i) service->wake(waker->host, waker->number);
  return NULL;
}

static void wake_calls(int run) {
  pthread_t thread;
  hooks.on_call = note_empty;
  app* self = app_open(FIXER_ALONE, (uint32_t)run);
  REQUIRE(waker, "no instance was activated");
  if (!SERVICE(waker->host, ODO_SERVICE_WAKE)) skip_case("the host has no odo.wake/1");
  push_rest_between(self, T0, T0 + 50 * MS);
  REQUIRE(pthread_create(&thread, NULL, wake_many, NULL) == 0, "no thread could be started");
  pthread_join(thread, NULL);
  if (run == ODO_RUN_REPLAY) {
    push_rest(self, T0 + 50 * MS);
    app_flush(self);
  } else {
    app_wait_events(self, PROBE_EVENT, 1); /* without another sample */
  }
  CHECK(empty_batches >= 1 && empty_batches <= 10, "10 requests were answered by %d calls; expected 1 to 10",
        empty_batches);
  EQUAL(events_of_wake, empty_batches);
  EQUAL(app_events(self, PROBE_EVENT), (size_t)events_of_wake);
}
IN_BOTH_RUNS(wake_calls, "a plugin of ", " that asked to be called is called with an empty batch", "plugin.h",
             "The host calls process of this instance with an empty batch");
