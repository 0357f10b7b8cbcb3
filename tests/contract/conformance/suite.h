/* SPDX-License-Identifier: Apache-2.0
 *
 * Conformance suite of the host's side: cases that check a libodograph.so against the sentences of the public
 * headers. C99
 * and POSIX; it includes only the public headers and loads the library at run time. */
#ifndef CONFORMANCE_SUITE_H
#define CONFORMANCE_SUITE_H

#include <stdbool.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <odograph/absolute_fixer.h>
#include <odograph/anchor.h>
#include <odograph/attitude.h>
#include <odograph/messages.h>
#include <odograph/odograph.h>
#include <odograph/recording.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

/* ---- cases ---- */
typedef struct conformance_case {
  const char* name;     /* a sentence */
  const char* header;   /* the header of the contract ... */
  const char* sentence; /* ... and its sentence that is checked */
  void (*run)(int argument);
  int argument;
  struct conformance_case* next;
} conformance_case;
void add_case(conformance_case* added);

/* CASE defines a case; CASE_OF adds one that calls a function with an argument, IN_BOTH_RUNS the two of "a replay" and
 * "a live session", named between the texts. */
#define CASE(name, header, sentence) CASE_BY(NUMBERED(case_, __COUNTER__), name, header, sentence)
#define CASE_OF(run, argument, name, header, sentence) \
  ADDED_BY(NUMBERED(add_, __COUNTER__), run, argument, name, header, sentence)
#define IN_BOTH_RUNS(run, before, after, header, sentence)                 \
  CASE_OF(run, ODO_RUN_REPLAY, before "a replay" after, header, sentence); \
  CASE_OF(run, ODO_RUN_LIVE, before "a live session" after, header, sentence)
#define NUMBERED(word, number) NUMBERED_AS(word, number)
#define NUMBERED_AS(word, number) word##number
#define CASE_BY(function, name, header, sentence) \
  static void function(int unused);               \
  CASE_OF(function, 0, name, header, sentence);   \
  static void function(int unused)
#define ADDED_BY(function, run, argument, name, header, sentence)                      \
  __attribute__((constructor)) static void function(void) {                            \
    static conformance_case added = {name, header, sentence, run, (int)(argument), 0}; \
    add_case(&added);                                                                  \
  }                                                                                    \
  struct conformance_case /* takes the semicolon */

/* Within a case. fail_at records a failure and continues, stop_at ends the case too; thread-safe. */
void fail_at(const char* file, int line, const char* format, ...);
__attribute__((noreturn)) void stop_at(const char* file, int line, const char* format, ...);
__attribute__((noreturn)) void skip_case(const char* format, ...);
void expect_equal(const char* file, int line, const char* what, int64_t value, int64_t expected);
void expect_status(const char* file, int line, const char* what, int64_t status, int64_t expected);

#define CHECK(condition, ...)                                   \
  do {                                                          \
    if (!(condition)) fail_at(__FILE__, __LINE__, __VA_ARGS__); \
  } while (0)
#define REQUIRE(condition, ...)                                 \
  do {                                                          \
    if (!(condition)) stop_at(__FILE__, __LINE__, __VA_ARGS__); \
  } while (0)
#define EQUAL(value, expected) expect_equal(__FILE__, __LINE__, #value, (int64_t)(value), (int64_t)(expected))
#define EXPECT(call, expected) expect_status(__FILE__, __LINE__, #call, (call), (expected))

/* ---- the library ---- */
#define CONFORMANCE_FUNCTIONS(X)                                                                   \
  X(int32_t, session_create, (const odo_session_options*, odo_session**, odo_error*))              \
  X(void, session_destroy, (odo_session*))                                                         \
  X(int32_t, session_push, (odo_session*, const odo_header*))                                      \
  X(int32_t, session_push_imu, (odo_session*, int64_t, const double*, const double*))              \
  X(int32_t, session_flush, (odo_session*))                                                        \
  X(int32_t, session_get_pose, (odo_session*, int64_t, odo_pose*))                                 \
  X(int32_t, session_get_pose_of, (odo_session*, uint32_t, uint32_t, int64_t, odo_pose*))          \
  X(int32_t, session_get_smooth_pose, (odo_session*, int64_t, odo_pose*))                          \
  X(int32_t, session_set_callback, (odo_session*, const uint32_t*, uint32_t, odo_callback, void*)) \
  X(int32_t, register_plugin, (odo_plugin_entry, odo_error*))                                      \
  X(uint64_t, current_plugin_call, (char*, uint64_t))                                              \
  X(int32_t, session_get_statistics, (odo_session*, odo_statistics*))                              \
  X(int32_t, session_last_error, (odo_session*, odo_error*))                                       \
  X(int32_t, session_to_geodetic, (odo_session*, const double*, double*))                          \
  X(int32_t, session_from_geodetic, (odo_session*, const double*, double*))                        \
  X(int64_t, session_save, (odo_session*, void*, uint64_t))                                        \
  X(int32_t, session_load, (odo_session*, const void*, uint64_t))                                  \
  X(const char*, version, (void))                                                                  \
  X(uint32_t, abi_version, (void))                                                                 \
  X(const char*, status_text, (int32_t))                                                           \
  X(const char*, state_text, (uint32_t))                                                           \
  X(const char*, reason_text, (uint32_t))                                                          \
  X(const char*, mode_text, (uint32_t))                                                            \
  X(int32_t, anchor_create, (odo_session*, const odo_anchor_place*, uint64_t*))                    \
  X(int32_t, anchor_get, (odo_session*, uint64_t, uint32_t, int64_t, odo_anchor*))                 \
  X(int64_t, anchor_list, (odo_session*, uint64_t*, uint64_t))                                     \
  X(int32_t, anchor_remove, (odo_session*, uint64_t))                                              \
  X(int32_t, recording_open, (const odo_string*, odo_recording**, odo_error*))                     \
  X(int32_t, recording_next, (odo_recording*, const odo_header**, const void**, uint64_t*))        \
  X(int32_t, recording_loss, (odo_recording*, odo_error*))                                         \
  X(void, recording_close, (odo_recording*))                                                       \
  X(int32_t, recorder_create, (const odo_string*, odo_recorder**, odo_error*))                     \
  X(int32_t, recorder_write, (odo_recorder*, const odo_header*, const void*, uint64_t))            \
  X(int32_t, recorder_close, (odo_recorder*))

#define CONFORMANCE_MEMBER(result, name, arguments) result(ODO_CALL* name) arguments;
typedef struct conformance_library {
  CONFORMANCE_FUNCTIONS(CONFORMANCE_MEMBER)
} conformance_library;
extern conformance_library odo;

/* Loads the library; null, or the reason for the failure. */
const char* library_open(const char* path);
/* Names of the headers' functions that the library lacks, separated by blanks; empty if it has all. A call of one
 * skips the case. */
const char* library_missing(void);

/* Options of the command line. */
typedef struct conformance_options {
  const char* plugin_folder; /* folder of the suite's plugins as shared libraries; null: they are registered */
  bool by_folder;            /* use plugin_folder although the library has odo_register_plugin */
} conformance_options;
extern conformance_options options;

/* ---- running ---- */
typedef enum outcome { PASSED, FAILED, SKIPPED } outcome;
#define RESULT_TEXT 8192
#define MAX_LINES 6u /* stored lines; `lines` counts further ones */
typedef struct result {
  outcome outcome;
  unsigned lines;
  double seconds;
  char text[RESULT_TEXT]; /* one line per failure, or the reason for a skip */
} result;
/* Runs a case in a separate process, which is killed after `limit_s` seconds. */
void run_case(const conformance_case* chosen, double limit_s, bool quiet, result* out);

/* ---- small things ---- */
#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))
typedef struct named_status {
  int32_t number;
  const char* name;
} named_status;
extern const named_status statuses[];
extern const size_t status_count;
const char* status_name(int64_t status);
odo_string string_of(const char* text);
/* A path in a new folder of this case. */
const char* case_file(const char* name);
void sleep_ms(unsigned milliseconds);
double now_s(void);

#endif
