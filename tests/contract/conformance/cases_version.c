/* SPDX-License-Identifier: Apache-2.0
 *
 * Functions that need no session. */
#include "app.h"

CASE("the version is three numbers", "odograph.h",
     "Returns the version of the library, \"major.minor.patch\", terminated; never null.") {
  unsigned major, minor, patch;
  char rest[2];
  REQUIRE(odo.version() != NULL, "odo_version gives null");
  CHECK(sscanf(odo.version(), "%u.%u.%u%1s", &major, &minor, &patch, rest) == 3, "odo_version gives \"%s\"",
        odo.version());
}

CASE("the ABI's version is major and minor", "odograph.h",
     "Returns the ABI version of the library: major << 16 | minor.") {
  EQUAL(odo.abi_version() >> 16, ODO_ABI_MAJOR);
}

CASE("every function of the headers is there", "base.h", "ODO_API marks the functions of the library.") {
  if (library_missing()[0]) skip_case("the library lacks %s", library_missing());
}

static const char* state_text(int64_t n) { return odo.state_text((uint32_t)n); }
static const char* reason_text(int64_t n) { return odo.reason_text((uint32_t)n); }
static const char* mode_text(int64_t n) { return odo.mode_text((uint32_t)n); }
/* The text of a status by its place in the list; an unknown one for another number. */
static const char* status_text(int64_t n) {
  return odo.status_text(n >= 0 && n < (int64_t)status_count ? statuses[n].number : (int32_t)n);
}

static void check_texts(const char* of, const char* (*text)(int64_t), int64_t from, int64_t to,
                        int64_t first_with_words) {
  static const int64_t far[] = {INT32_MIN, INT32_MAX, 1000, -1000};
  int64_t i, j;
  for (i = from; i <= to; ++i) {
    REQUIRE(text(i) != NULL, "the text of %s %lld is null", of, (long long)i);
    CHECK(i < first_with_words || text(i)[0], "the text of %s %lld is empty", of, (long long)i);
    for (j = from; j < i; ++j)
      CHECK(strcmp(text(i), text(j)) != 0, "%s %lld and %lld are both \"%s\"", of, (long long)i, (long long)j, text(i));
  }
  for (i = 0; i < (int64_t)COUNT_OF(far); ++i)
    CHECK(text(far[i]) != NULL, "the text of the unknown %s %lld is null", of, (long long)far[i]);
}

CASE("each status, state, reason and mode has words of its own", "odograph.h",
     "Return the text of a status code, a state (ODO_TRACKING ...), a reason or a motion mode; never null.") {
  check_texts("status", status_text, 0, (int64_t)status_count - 1, 0);
  check_texts("state", state_text, ODO_TRACKING, ODO_LOST, ODO_TRACKING);
  check_texts("reason", reason_text, ODO_REASON_NONE, ODO_REASON_NO_ORIGIN, ODO_REASON_INITIALISING);
  check_texts("motion mode", mode_text, ODO_MODE_UNKNOWN, ODO_MODE_HANDLING, ODO_MODE_STATIC);
}

CASE("null where something is needed is an argument error", "base.h", "the call violates the contract") {
  odo_session* session = (odo_session*)&session;
  odo_error error = {sizeof error, 0, ""};
  odo_session_options chosen = {.struct_size = sizeof chosen};
  EXPECT(odo.session_create(NULL, &session, &error), ODO_E_ARGUMENT);
  CHECK(session == NULL, "*session is not null after a failure");
  CHECK(error.message[0] && memchr(error.message, 0, sizeof error.message), "no reason was written");
  EXPECT(odo.session_create(&chosen, NULL, NULL), ODO_E_ARGUMENT);
  EXPECT(odo.session_push(NULL, NULL), ODO_E_ARGUMENT);
  EXPECT(odo.session_flush(NULL), ODO_E_ARGUMENT);
  EXPECT(odo.session_get_pose(NULL, 0, NULL), ODO_E_ARGUMENT);
  EXPECT(odo.session_get_statistics(NULL, NULL), ODO_E_ARGUMENT);
}

CASE("destroying null does nothing", "odograph.h",
     "Stops the thread of the session, destroys the plugin instances and releases retained frames.") {
  odo.session_destroy(NULL);
}

static char within[128], cut[8];
static uint64_t within_size, cut_size;

static int32_t ask_for_call(odo_instance* instance, const odo_header* message) {
  within_size = odo.current_plugin_call(within, sizeof within - 1);
  memset(cut, '#', sizeof cut);
  cut_size = odo.current_plugin_call(cut, 4);
  return ODO_OK;
}

CASE("the current plugin call names the plugin and the call", "odograph.h",
     "Writes at most `capacity` bytes, unterminated, and returns their number; 0: no such call.") {
  char outside[64];
  hooks.on_message = ask_for_call;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  CHECK(odo.current_plugin_call(outside, sizeof outside) == 0, "there is a call outside of any plugin's");
  FLUSHED(self, push_barometer(self, T0));
  CHECK(strcmp(within, "conformance/probe in process") == 0, "within process it gives \"%s\"", within);
  CHECK(within_size == strlen("conformance/probe in process"), "it returned %llu", (unsigned long long)within_size);
  CHECK(memcmp(cut, "conf####", 8) == 0, "with a capacity of 4 it wrote \"%.8s\"", cut);
  EQUAL(cut_size, 4);
}
