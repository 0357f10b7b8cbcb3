/* SPDX-License-Identifier: Apache-2.0
 *
 * Life cycle of an instance: its calls, their order, never concurrent. */
#include "app.h"

#define ORDER "Order of calls to an instance: create, configure, activate, process ... [reset | save | load], destroy."

static bool begins_with(const char* words, const char* start) { return strncmp(words, start, strlen(start)) == 0; }

static void order_of_calls(int run) {
  app* self = app_open(FIXER_ALONE, (uint32_t)run);
  push_rest_between(self, T0, T0 + 200 * MS);
  app_flush(self);
  CHECK(journal_count(PROBE_DESTROY, FIXER) == 0, "the instance was destroyed before the session");
  app_close(self);
  const char* words = journal_words(FIXER);
  size_t size = strlen(words);
  CHECK(begins_with(words, "create configure activate process"), "the calls were: %s", words);
  CHECK(size > 8 && strcmp(words + size - 8, " destroy") == 0, "the last calls were: %s",
        words + (size > 60 ? size - 60 : 0));
  CHECK(journal_count(PROBE_CREATE, FIXER) == 1 && journal_count(PROBE_CONFIGURE, FIXER) == 1 &&
            journal_count(PROBE_ACTIVATE, FIXER) == 1 && journal_count(PROBE_DESTROY, FIXER) == 1,
        "a call was made more than once: %s", words);
}
IN_BOTH_RUNS(order_of_calls, "an instance of ", " is created, configured, activated, used and destroyed in order",
             "plugin.h", ORDER);

static void unused_session(int run) {
  app* self = app_open(FIXER_ALONE, (uint32_t)run);
  app_close(self);
  CHECK(strcmp(journal_words(FIXER), "create configure activate destroy") == 0, "the calls were: %s",
        journal_words(FIXER));
}
IN_BOTH_RUNS(unused_session, "an instance of ", " without samples is destroyed", "plugin.h", ORDER);

/* ---- parameters ---- */
static struct {
  int64_t answer;
  char word[32];
  uint32_t count;
} configured;

static int64_t note_values(probe_call* call) {
  if (call->what != PROBE_CONFIGURE) return ODO_OK;
  configured.count = call->count;
  for (uint32_t i = 0; i < call->count; ++i) {
    const odo_value* value = (const odo_value*)(const void*)((const char*)call->values + i * call->size);
    if (value->name.size == 6 && memcmp(value->name.data, "answer", 6) == 0 && value->type == ODO_PARAMETER_INT)
      configured.answer = value->integer;
    if (value->name.size == 4 && memcmp(value->name.data, "word", 4) == 0 && value->type == ODO_PARAMETER_STRING)
      snprintf(configured.word, sizeof configured.word, "%.*s", (int)value->text.size, value->text.data);
  }
  return ODO_OK;
}

CASE("configure is given every parameter, by default as the table has it", "plugin.h",
     "called once, before activate.") {
  hooks.on_call = note_values;
  app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  CHECK(configured.count == 2 && configured.answer == 42 && strcmp(configured.word, "none") == 0,
        "it was given %u values, answer %lld and word \"%s\"; expected 2, 42 and \"none\"", configured.count,
        (long long)configured.answer, configured.word);
}

CASE("configure is given what the config has", "plugin.h",
     "A parameter value from the config, validated against the table.") {
  hooks.on_call = note_values;
  app_open(FIXER_ALONE "    parameters:\n      answer: 17\n      word: hello\n", ODO_RUN_REPLAY);
  CHECK(configured.answer == 17 && strcmp(configured.word, "hello") == 0, "it was given answer %lld and word \"%s\"",
        (long long)configured.answer, configured.word);
}

CASE("a parameter out of its range is refused before the plugin is given it", "odograph.h",
     "file:line:column of an error in the config") {
  const odo_session_options chosen = app_options(FIXER_ALONE "    parameters:\n      answer: 101\n", ODO_RUN_REPLAY);
  odo_session* session;
  odo_error error = {sizeof error, 0, ""};
  need_plugins();
  EXPECT(odo.session_create(&chosen, &session, &error), ODO_E_CONFIG);
  CHECK(session == NULL, "*session is not null after a failure");
  CHECK(strstr(error.message, "answer") && strstr(error.message, "5:"), "the reason names neither key nor line: %s",
        error.message);
  CHECK(journal_count(PROBE_CONFIGURE, ANY_KIND) == 0, "the plugin was given a value out of its range");
}

/* ---- never at once ---- */
static int32_t take_a_while(odo_instance* instance, const odo_header* message) {
  sleep_ms(1);
  return ODO_OK;
}

static void* push_steadily(void* user) {
  app* self = (app*)user;
  for (int i = 0; i < 300; ++i) push_rest(self, T0 + i * 10 * MS);
  return NULL;
}

static void never_at_once(int run) {
  char blob[4096];
  pthread_t thread;
  hooks.on_message = take_a_while;
  app* self = app_open(FIXER_ALONE, (uint32_t)run);
  REQUIRE(pthread_create(&thread, NULL, push_steadily, self) == 0, "no thread could be started");
  for (int i = 0; i < 50; ++i) {
    const int64_t size = odo.session_save(self->session, blob, sizeof blob);
    CHECK(size >= 0, "odo_session_save = %s", status_name(size));
    if (size > 0) EXPECT(odo.session_load(self->session, blob, (uint64_t)size), ODO_OK);
    if (i % 10 == 0) app_flush(self);
  }
  pthread_join(thread, NULL);
  app_flush(self);
  CHECK(journal_count(PROBE_SAVE, FIXER) > 0, "save was never called");
  app_close(self);
  EQUAL(journal_overlaps(), 0);
}
IN_BOTH_RUNS(never_at_once, "calls to an instance of ", " never overlap", "plugin.h",
             "[control] and [process] calls to one instance are ordered and never overlap");

CASE("instances are numbered in the order of their kinds", "plugin.h", "`number` identifies it in reports.") {
  const journal_entry *first, *second;
  app_open(CONFIG WITH_ATTITUDE WITH_FRONTEND WITH_FIXER, ODO_RUN_REPLAY);
  first = journal_find(PROBE_CREATE, ATTITUDE, 0), second = journal_find(PROBE_CREATE, FIXER, 0);
  REQUIRE(first && second && journal_find(PROBE_CREATE, FRONTEND, 0), "not all instances were made: %s",
          journal_words(ANY_KIND));
  CHECK(first->number == 1 && journal_find(PROBE_CREATE, FRONTEND, 0)->number == 2 && second->number == 3,
        "the numbers are %u, %u and %u; expected 1, 2 and 3", first->number,
        journal_find(PROBE_CREATE, FRONTEND, 0)->number, second->number);
}

CASE("a table without optional functions is used", "plugin.h", "The remaining members are optional and may be null.") {
  app* self = app_open(CONFIG WITH_ATTITUDE "vo_frontend:\n  plugin: conformance/bare\n", ODO_RUN_REPLAY);
  odo_calibration calibration;
  odo_frame frame;
  char blob[4096];
  put_calibration(&calibration, 0, T0);
  EXPECT(push(self, &calibration), ODO_OK);
  put_frame(&frame, 0, T0 + MS);
  FLUSHED(self, push(self, &frame));
  CHECK(given_count(ODO_TYPE_FRAME, FRONTEND) == 1, "it was not given the frame");
  CHECK(odo.session_save(self->session, blob, sizeof blob) >= 0, "odo_session_save failed");
  app_close(self);
}
