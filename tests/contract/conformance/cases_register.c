/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugins that are linked into the program. */
#include "app.h"

#define RETURNS                                                                                                     \
  "ODO_E_ARGUMENT (null), ODO_E_VERSION, ODO_E_CONFIG (another registered plugin has its id) or the status of the " \
  "entry"

static void register_all(void) {
  options.by_folder = false;
  need_plugins();
}

CASE("registering null is refused", "odograph.h", RETURNS) {
  odo_error error = {sizeof error, 0, ""};
  EXPECT(odo.register_plugin(NULL, &error), ODO_E_ARGUMENT);
  CHECK(error.message[0], "there is no reason");
  EXPECT(odo.register_plugin(NULL, NULL), ODO_E_ARGUMENT);
}

CASE("a registered plugin is found by its id", "odograph.h", "Sessions created later find it by its id") {
  register_all();
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  push_rest_between(self, T0, T0 + 100 * MS);
  app_flush(self);
  EQUAL(given_count(ODO_TYPE_IMU, FIXER), 10);
}

CASE("registering an entry again changes nothing", "odograph.h", "Registering an entry again has no effect.") {
  odo_error error = {sizeof error, 0, ""};
  register_all();
  for (int i = 0; i < 3; ++i) EXPECT(odo.register_plugin(probe_entries[PROBE_FULL], &error), ODO_OK);
  app_close(app_open(FIXER_ALONE, ODO_RUN_REPLAY));
  EQUAL(journal_count(PROBE_CREATE, FIXER), 1);
}

/* ---- other entries ---- */
static int32_t ODO_CALL twin(const odo_host* host, odo_plugin* out) { return probe_entries[PROBE_FULL](host, out); }

static void refused(odo_plugin_entry entry, int32_t expected, const char* word) {
  odo_error error = {sizeof error, 0, ""};
  int32_t status = odo.register_plugin(entry, &error);
  CHECK(expected == 0 ? status < 0 : status == expected, "odo_register_plugin = %s", status_name(status));
  CHECK(error.status == status && error.message[0], "the error has status %s and message \"%s\"",
        status_name(error.status), error.message);
  if (word) CHECK(strstr(error.message, word), "the reason is \"%s\"", error.message);
  CHECK(odo.register_plugin(entry, NULL) == status, "without an error struct the status is another");
}

CASE("another plugin of a registered id is refused", "odograph.h", RETURNS) {
  register_all();
  refused(twin, ODO_E_CONFIG, "conformance/probe");
}

/* What an entry does wrong. */
typedef struct fault {
  int32_t status;                  /* instead of filling the table ... */
  const char* refusal;             /* ... for this reason */
  const char* id;                  /* of the table */
  uint32_t abi_major, struct_size; /* of the table, if not 0 */
  bool without_functions;
  int32_t expected; /* 0: any error */
  const char* word; /* in the reason */
} fault;
enum { REFUSES, TOO_OLD, OTHER_MAJOR, NO_ID, NO_FUNCTIONS, FAILS, TOO_SMALL, RESERVED_ID };
static const fault faults[] = {
    [REFUSES] = {.status = ODO_E_CONFIG,
                 .refusal = "the licence has expired",
                 .expected = ODO_E_CONFIG,
                 .word = "the licence has expired"},
    [TOO_OLD] = {.status = ODO_E_VERSION,
                 .refusal = "made for another ABI",
                 .expected = ODO_E_VERSION,
                 .word = "made for another ABI"},
    [OTHER_MAJOR] = {.id = "conformance/another_major", .abi_major = ODO_ABI_MAJOR + 1, .expected = ODO_E_VERSION},
    [NO_ID] = {.id = ""},
    [NO_FUNCTIONS] = {.id = "conformance/without_functions", .without_functions = true},
    [FAILS] = {.status = ODO_E_MEMORY, .expected = ODO_E_MEMORY},
    [TOO_SMALL] = {.id = "conformance/too_small",
                   .struct_size = ODO_PLUGIN_SIZE_MIN - 8,
                   .expected = ODO_E_STRUCT_SIZE},
    [RESERVED_ID] = {.id = "host/of_the_host", .word = "host/of_the_host"}};
static const fault* wrong;

static int32_t ODO_CALL bad_entry(const odo_host* host, odo_plugin* out) {
  if (wrong->refusal) out->refusal = string_of(wrong->refusal);
  if (wrong->status) return wrong->status;
  const int32_t status = probe_entries[PROBE_FULL](host, out);
  out->id = string_of(wrong->id);
  if (wrong->abi_major) out->abi_major = wrong->abi_major;
  if (wrong->struct_size) out->struct_size = wrong->struct_size;
  if (wrong->without_functions) out->create = NULL, out->process = NULL;
  return status;
}

static void bad_entries(int which) {
  wrong = &faults[which];
  refused(bad_entry, wrong->expected, wrong->word);
}
CASE_OF(bad_entries, REFUSES, "an entry that refuses is refused with its reason", "odograph.h", RETURNS);
CASE_OF(bad_entries, TOO_OLD, "an entry for another ABI is refused with its reason", "odograph.h", RETURNS);
CASE_OF(bad_entries, OTHER_MAJOR, "a table of another major version is refused", "base.h",
        "An incompatible change raises the major version");
CASE_OF(bad_entries, RESERVED_ID, "a table with an id of a reserved group is refused", "plugin.h",
        "groups \"odo\" and \"host\" are reserved");
CASE_OF(bad_entries, NO_ID, "a table without an id is refused", "odograph.h",
        "`error`, which may be null, has the reason");
CASE_OF(bad_entries, NO_FUNCTIONS, "a table without its functions is refused", "odograph.h",
        "`error`, which may be null, has the reason");
CASE_OF(bad_entries, TOO_SMALL, "a table smaller than 1.0 is refused", "base.h",
        "A struct smaller than in version 1.0 is rejected.");
CASE_OF(bad_entries, FAILS, "an entry that fails gives its status", "odograph.h", RETURNS);

CASE("a registration that was refused does no harm to others", "odograph.h", RETURNS) {
  bad_entries(NO_FUNCTIONS);
  register_all();
  app_close(app_open(FIXER_ALONE, ODO_RUN_REPLAY));
}

CASE("a registered plugin comes before one in a folder", "odograph.h", "before plugins in directories") {
  if (!options.plugin_folder) skip_case("needs a folder of plugins");
  register_all();
  app_walk(1);
  EQUAL(journal_count(PROBE_CREATE, ANY_KIND), 3);
}

/* Two sessions of one plugin, the second created while the first is in use. */
CASE("a registered plugin serves several sessions", "base.h",
     "It is called once for each session or tool that uses the plugin") {
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

CASE("a registered plugin cannot be isolated in a process", "odograph.h",
     "It needs no manifest and cannot be isolated in a process.") {
  const odo_session_options chosen = app_options(FIXER_ALONE "    isolation: process\n", ODO_RUN_REPLAY);
  odo_session* session = NULL;
  odo_error error = {sizeof error, 0, ""};
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

CASE("entries are registered from several threads at once", "odograph.h",
     "Registers a plugin that is linked into the program") {
  pthread_t threads[4];
  void* failed;
  for (int i = 0; i < 4; ++i)
    REQUIRE(pthread_create(&threads[i], NULL, register_many, &threads) == 0, "no thread could be started");
  for (int i = 0; i < 4; ++i) {
    pthread_join(threads[i], &failed);
    CHECK(!failed, "a registration failed on thread %d", i);
  }
}
