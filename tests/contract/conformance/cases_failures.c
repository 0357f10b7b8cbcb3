/* SPDX-License-Identifier: Apache-2.0
 *
 * Effect of a plugin's status on its instance. */
#include "app.h"

#define DISCARDS "-1 to -999: the input is discarded, the state unchanged"
#define NEEDS_RESET "-1000 to -1999: a plugin instance needs reset or load"

static struct {
  uint32_t within; /* the call that fails */
  int32_t status;
  int after; /* calls before it fails */
  int times; /* number of failures; 0: always */
  int failed;
} plan;

static int64_t fail_call(probe_call* call) {
  if (call->what != plan.within || (plan.times && plan.failed >= plan.times)) return ODO_OK;
  if (plan.after > 0) return --plan.after, ODO_OK;
  ++plan.failed;
  return plan.status;
}

/* `expected`: 0: any error. */
static void cannot_be_made(uint32_t within, int32_t status, int32_t expected) {
  const odo_session_options chosen = app_options(CONFIG WITH_ATTITUDE WITH_FIXER, ODO_RUN_REPLAY);
  odo_session* session = NULL;
  odo_error error = {sizeof error, 0, ""};
  size_t made, ended;
  need_plugins();
  plan.within = within, plan.status = status, plan.after = 1; /* the second instance fails */
  hooks.on_call = fail_call;
  int32_t got = odo.session_create(&chosen, &session, &error);
  CHECK(expected == 0 ? got < 0 : got == expected, "odo_session_create = %s", status_name(got));
  CHECK(session == NULL, "*session is not null after a failure");
  CHECK(strstr(error.message, "conformance/probe"), "the reason does not name the plugin: %s", error.message);
  made = journal_count(PROBE_CREATE, ANY_KIND) - (within == PROBE_CREATE);
  ended = journal_count(PROBE_DESTROY, ANY_KIND);
  CHECK(made == ended, "%u instances were made and %u destroyed", (unsigned)made, (unsigned)ended);
  CHECK(journal_count(PROBE_PROCESS, ANY_KIND) == 0, "an instance was used");
}

CASE("a session whose plugin cannot be created is not made, and nothing is left", "odograph.h",
     "On failure *session is null") {
  cannot_be_made(PROBE_CREATE, ODO_E_MEMORY, 0);
}
CASE("a session whose plugin refuses its configuration is not made, and nothing is left", "base.h",
     "invalid configuration; the instance stays unconfigured") {
  cannot_be_made(PROBE_CONFIGURE, ODO_E_CONFIG, ODO_E_CONFIG);
}
CASE("a session whose plugin cannot be activated is not made, and nothing is left", "odograph.h",
     "On failure *session is null") {
  cannot_be_made(PROBE_ACTIVATE, ODO_E_ERROR, 0);
}

/* `count` barometer samples, one per second; process returns `status`, once or always, from the third one on. */
static app* run_failing(int32_t status, int times, int count) {
  plan.within = PROBE_PROCESS, plan.status = status, plan.times = times, plan.after = 2;
  hooks.on_call = fail_call;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  for (int i = 0; i < count; ++i) {
    FLUSHED(self, push_barometer(self, T0 + i * SECOND));
  }
  return self;
}

static void unchanged_after(int status) {
  app* self = run_failing(status, 1, 10);
  CHECK(journal_count(PROBE_RESET, FIXER) == 0 && journal_count(PROBE_CREATE, FIXER) == 1, "the calls were: %s",
        journal_words(FIXER));
  EQUAL(given_count(ODO_TYPE_BAROMETER, FIXER), 10);
  CHECK(app_statistics(self).plugin_faults == 0 || status != ODO_NOT_READY, "plugin_faults is %llu",
        (unsigned long long)app_statistics(self).plugin_faults);
}
CASE_OF(unchanged_after, ODO_NOT_READY, "a plugin that is not ready goes on", "base.h",
        "no output yet, no error; state unchanged");
CASE_OF(unchanged_after, ODO_E_DISCARD, "a plugin that discards its input goes on", "base.h", DISCARDS);
CASE_OF(unchanged_after, -999, "an unknown status above -1000 discards", "base.h", DISCARDS);

static void reset_after(int status) {
  app* self = run_failing(status, 1, 10);
  const char* words = journal_words(FIXER);
  CHECK(strstr(words, "create configure activate process process process reset") ||
            strstr(words, "create configure activate process process process load"),
        "the calls were: %s", words);
  CHECK(given_count(ODO_TYPE_BAROMETER, FIXER) > 3, "it was given nothing after it failed");
  CHECK(app_statistics(self).plugin_faults >= 1, "it is not counted as a fault");
  CHECK(app_events(self, ODO_TYPE_REPORT) >= 1, "it is not reported");
}
CASE_OF(reset_after, ODO_E_ERROR, "a plugin that failed is reset before it is called again", "base.h", NEEDS_RESET);
CASE_OF(reset_after, ODO_E_MEMORY, "a plugin that was out of memory is reset before it is called again", "base.h",
        NEEDS_RESET);
CASE_OF(reset_after, -1999, "an unknown status below -1000 needs a reset", "base.h", NEEDS_RESET);

CASE("a plugin that failed fatally is not called again", "base.h", "the whole plugin library is quarantined") {
  app* self = run_failing(ODO_E_FATAL, 0, 10);
  CHECK(plan.failed == 1 && given_count(ODO_TYPE_BAROMETER, FIXER) == 3, "it was called again: %s",
        journal_words(FIXER));
  app_close(self);
}

CASE("a plugin that always fails ends without harm", "plugin.h",
     "Order of calls to an instance: create, configure, activate, process") {
  app* self = run_failing(ODO_E_ERROR, 0, 60);
  app_close(self);
  EQUAL(journal_count(PROBE_CREATE, FIXER), journal_count(PROBE_DESTROY, FIXER));
}

static void unknown_status(int status) {
  app* self = run_failing(status, 1, 10);
  CHECK(given_count(ODO_TYPE_BAROMETER, FIXER) >= 4, "it was given nothing after an unknown status");
  app_close(self);
}
CASE_OF(unknown_status, 99, "an unknown positive status is no error", "base.h",
        "Zero is success, negative values are errors.");
