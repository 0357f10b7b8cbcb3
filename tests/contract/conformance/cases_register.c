/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugins that are linked into the program. */
#include "app.h"

#include <string.h>

static void register_all(void) {
  NEED(register_plugin);
  options.by_folder = false;
  need_plugins();
}

static void null_entry(int unused) {
  odo_error error = {sizeof error, 0, ""};
  NEED(register_plugin);
  EXPECT(odo.register_plugin(NULL, &error), ODO_E_ARGUMENT);
  CHECK(error.message[0], "there is no reason");
  EXPECT(odo.register_plugin(NULL, NULL), ODO_E_ARGUMENT);
}

static void found_by_id(int unused) {
  register_all();
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  push_rest_between(self, T0, T0 + 100 * MS);
  app_flush(self);
  EQUAL(given_count(ODO_TYPE_IMU, FIXER), 10);
}

static void again_changes_nothing(int unused) {
  odo_error error = {sizeof error, 0, ""};
  register_all();
  for (int i = 0; i < 3; ++i) EXPECT(odo.register_plugin(probe_entries[PROBE_FULL], &error), ODO_OK);
  app_close(app_open(FIXER_ALONE, ODO_RUN_REPLAY));
  EQUAL(journal_count(PROBE_CREATE, FIXER), 1);
}

/* ---- other entries ---- */
static int32_t ODO_CALL twin(const odo_host* host, odo_plugin* out) { return probe_entries[PROBE_FULL](host, out); }

static int32_t ODO_CALL refusing(const odo_host* host, odo_plugin* out) {
  out->refusal = string_of("the licence has expired");
  return ODO_E_CONFIG;
}

static int32_t ODO_CALL too_old(const odo_host* host, odo_plugin* out) {
  out->refusal = string_of("made for another ABI");
  return ODO_E_VERSION;
}

static int32_t ODO_CALL of_another_major(const odo_host* host, odo_plugin* out) {
  const int32_t status = probe_entries[PROBE_FULL](host, out);
  out->abi_major = ODO_ABI_MAJOR + 1;
  out->id = string_of("conformance/another_major");
  return status;
}

static int32_t ODO_CALL without_id(const odo_host* host, odo_plugin* out) {
  const int32_t status = probe_entries[PROBE_FULL](host, out);
  out->id = string_of("");
  return status;
}

static int32_t ODO_CALL of_the_host(const odo_host* host, odo_plugin* out) {
  const int32_t status = probe_entries[PROBE_FULL](host, out);
  out->id = string_of("host/of_the_host");
  return status;
}

static int32_t ODO_CALL without_functions(const odo_host* host, odo_plugin* out) {
  const int32_t status = probe_entries[PROBE_FULL](host, out);
  out->id = string_of("conformance/without_functions");
  out->create = NULL, out->process = NULL;
  return status;
}

static int32_t ODO_CALL too_small(const odo_host* host, odo_plugin* out) {
  const int32_t status = probe_entries[PROBE_FULL](host, out);
  out->id = string_of("conformance/too_small");
  out->struct_size = ODO_PLUGIN_SIZE_MIN - 8;
  return status;
}

static int32_t ODO_CALL failing(const odo_host* host, odo_plugin* out) { return ODO_E_MEMORY; }

static void refused(odo_plugin_entry entry, int32_t expected, const char* word) {
  odo_error error = {sizeof error, 0, ""};
  NEED(register_plugin);
  int32_t status = odo.register_plugin(entry, &error);
  CHECK(expected == 0 ? status < 0 : status == expected, "odo_register_plugin = %s", status_name(status));
  CHECK(error.status == status && error.message[0], "the error has status %s and message \"%s\"",
        status_name(error.status), error.message);
  if (word) CHECK(strstr(error.message, word), "the reason is \"%s\"", error.message);
  CHECK(odo.register_plugin(entry, NULL) == status, "without an error struct the status is another");
}

static void same_id(int unused) {
  register_all();
  refused(twin, ODO_E_CONFIG, "conformance/probe");
}

static void bad_entries(int which) {
  static const odo_plugin_entry entries[] = {refusing,          too_old, of_another_major, without_id,
                                             without_functions, failing, too_small,        of_the_host};
  static const int32_t expected[] = {
      ODO_E_CONFIG, ODO_E_VERSION, ODO_E_VERSION, 0, 0, ODO_E_MEMORY, ODO_E_STRUCT_SIZE, 0};
  static const char* const words[] = {"the licence has expired", "made for another ABI", NULL, NULL, NULL, NULL, NULL,
                                      "host/of_the_host"};
  refused(entries[which], expected[which], words[which]);
}

static void refused_then_another(int unused) {
  refused(without_functions, 0, NULL);
  register_all();
  app_close(app_open(FIXER_ALONE, ODO_RUN_REPLAY));
}

static void before_the_folder(int unused) {
  if (!options.plugin_folder) skip_case("needs a folder of plugins");
  register_all();
  hooks.on_message = walk_message;
  app* self = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
  walk_second(self, 0);
  app_flush(self);
  EQUAL(journal_count(PROBE_CREATE, ANY_KIND), 3);
}

/* Two sessions of one plugin, the second created while the first is in use. */
static void in_several_sessions(int unused) {
  app *first, *second;
  register_all();
  first = app_open(FIXER_ALONE, ODO_RUN_LIVE);
  push_rest_between(first, T0, T0 + SECOND);
  second = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  push_rest_between(second, T0, T0 + SECOND);
  app_flush(first), app_flush(second);
  EQUAL(given_count(ODO_TYPE_IMU, FIXER), 200);
  app_close(first), app_close(second);
}

static void no_process_of_its_own(int unused) {
  const odo_session_options chosen = app_options(FIXER_ALONE "    isolation: process\n", ODO_RUN_REPLAY);
  odo_session* session = NULL;
  odo_error error = {sizeof error, 0, ""};
  NEED(session_create);
  if (options.plugin_folder) skip_case("the plugin lies in a folder too");
  register_all();
  CHECK(odo.session_create(&chosen, &session, &error) < 0 && !session, "a registered plugin was isolated in a process");
  CHECK(strstr(error.message, "conformance/probe"), "the reason does not name the plugin: %s", error.message);
}

static void* register_many(void* unused) {
  for (int i = 0; i < 200; ++i)
    if (odo.register_plugin(probe_entries[i % PROBE_VARIANTS], NULL) != ODO_OK) return unused;
  return NULL;
}

static void from_several_threads(int unused) {
  pthread_t threads[4];
  void* failed;
  NEED(register_plugin);
  for (int i = 0; i < 4; ++i)
    REQUIRE(pthread_create(&threads[i], NULL, register_many, &threads) == 0, "no thread could be started");
  for (int i = 0; i < 4; ++i) {
    pthread_join(threads[i], &failed);
    CHECK(!failed, "a registration failed on thread %d", i);
  }
}

#define RETURNS                                                                                                     \
  "ODO_E_ARGUMENT (null), ODO_E_VERSION, ODO_E_CONFIG (another registered plugin has its id) or the status of the " \
  "entry"
const conformance_case cases_register[] = {
    {"registering null is refused", "odograph.h", RETURNS, null_entry, 0},
    {"a registered plugin is found by its id", "odograph.h", "Sessions created later find it by its id", found_by_id,
     0},
    {"registering an entry again changes nothing", "odograph.h", "Registering an entry again has no effect.",
     again_changes_nothing, 0},
    {"another plugin of a registered id is refused", "odograph.h", RETURNS, same_id, 0},
    {"an entry that refuses is refused with its reason", "odograph.h", RETURNS, bad_entries, 0},
    {"an entry for another ABI is refused with its reason", "odograph.h", RETURNS, bad_entries, 1},
    {"a table of another major version is refused", "base.h", "An incompatible change raises the major version",
     bad_entries, 2},
    {"a table with an id of a reserved group is refused", "plugin.h", "groups \"odo\" and \"host\" are reserved",
     bad_entries, 7},
    {"a table without an id is refused", "odograph.h", "`error`, which may be null, has the reason", bad_entries, 3},
    {"a table without its functions is refused", "odograph.h", "`error`, which may be null, has the reason",
     bad_entries, 4},
    {"a table smaller than 1.0 is refused", "base.h", "A struct smaller than in version 1.0 is rejected.", bad_entries,
     6},
    {"an entry that fails gives its status", "odograph.h", RETURNS, bad_entries, 5},
    {"a registration that was refused does no harm to others", "odograph.h", RETURNS, refused_then_another, 0},
    {"a registered plugin comes before one in a folder", "odograph.h", "before plugins in directories",
     before_the_folder, 0},
    {"a registered plugin serves several sessions", "base.h",
     "It is called once for each session or tool that uses the plugin", in_several_sessions, 0},
    {"a registered plugin cannot be isolated in a process", "odograph.h",
     "It needs no manifest and cannot be isolated in a process.", no_process_of_its_own, 0},
    {"entries are registered from several threads at once", "odograph.h",
     "Registers a plugin that is linked into the program", from_several_threads, 0},
    {NULL, NULL, NULL, NULL, 0}};
