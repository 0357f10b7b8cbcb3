/* SPDX-License-Identifier: Apache-2.0
 *
 * The callback: its thread, permitted calls, its end. */
#include "app.h"

#define RULE "Called on the thread of the session (live) or within push or flush (replay)."

static int32_t event_for_each(odo_instance* instance, const odo_header* message) {
  odo_header event;
  put_header(&event, sizeof event, PROBE_EVENT, message->t_ns);
  return probe_emit(instance, &event);
}

static app* open_with_events(uint32_t run) {
  hooks.on_message = event_for_each;
  return app_open(FIXER_ALONE, run);
}

static pthread_t caller;
static int within_call, elsewhere, outside;

static void note_thread(app* self, const odo_header* event) {
  if (!pthread_equal(pthread_self(), caller)) ++elsewhere;
  if (!within_call) ++outside;
}

CASE("a replay's events come within push and flush, on the caller's thread", "odograph.h", RULE) {
  app* self = open_with_events(ODO_RUN_REPLAY);
  caller = pthread_self();
  self->on_event = note_thread;
  for (int i = 0; i < 100; ++i) {
    within_call = 1;
    EXPECT(push_rest(self, T0 + i * 10 * MS), ODO_OK);
    within_call = 0;
    sleep_ms(1);
  }
  CHECK(app_events(self, PROBE_EVENT) > 0, "there was no event before the flush");
  within_call = 1;
  app_flush(self);
  EQUAL(app_events(self, PROBE_EVENT), 100);
  EQUAL(elsewhere, 0);
  EQUAL(outside, 0);
}

CASE("a live session's events come on one thread of its own", "odograph.h", RULE) {
  app* self = open_with_events(ODO_RUN_LIVE);
  caller = pthread_self();
  self->on_event = note_thread;
  push_rest_between(self, T0, T0 + SECOND);
  REQUIRE(app_wait_events(self, PROBE_EVENT, 1), "there was no event");
  pthread_t first = self->callback_thread;
  app_flush(self);
  EQUAL(app_events(self, PROBE_EVENT), 100);
  CHECK(elsewhere >= 100, "%d of 100 events came on the session's thread", elsewhere);
  CHECK(pthread_equal(first, self->callback_thread), "events came on several threads");
}

/* ---- the end ---- */
static volatile int ended;
static int after_end;

static void slow(app* self, const odo_header* event) {
  if (ended) ++after_end;
  sleep_ms(2);
  if (ended) ++after_end;
}

static void no_call_after_the_end(int run) {
  app* self = open_with_events((uint32_t)run);
  self->on_event = slow;
  push_rest_between(self, T0, T0 + SECOND);
  if (run == ODO_RUN_LIVE) app_wait_events(self, PROBE_EVENT, 3);
  EXPECT(odo.session_set_callback(self->session, NULL, 0, NULL, NULL), ODO_OK);
  ended = 1;
  push_rest_between(self, T0 + SECOND, T0 + 2 * SECOND);
  app_flush(self);
  CHECK(after_end == 0, "a call ran after odo_session_set_callback had returned");
}
IN_BOTH_RUNS(no_call_after_the_end, "no call runs after ", "'s callback was ended", "odograph.h",
             "With count 0 or a null function, no more calls follow; after the return none is running");

static int inner_calls;
static void end_from_within(app* self, const odo_header* event) {
  ++inner_calls;
  EXPECT(odo.session_set_callback(self->session, NULL, 0, NULL, NULL), ODO_OK);
}

static void ended_from_within(int run) {
  app* self = open_with_events((uint32_t)run);
  self->on_event = end_from_within;
  push_rest_between(self, T0, T0 + SECOND);
  app_flush(self);
  EQUAL(inner_calls, 1);
}
IN_BOTH_RUNS(ended_from_within, "a callback of ", " may end itself", "odograph.h",
             "except the one that called this function");

/* ---- what it may call ---- */
static void call_everything(app* self, const odo_header* event) {
  odo_statistics counts;
  odo_error error;
  odo_anchor anchor;
  uint64_t ids[4];
  char text[64];
  if (event->type != PROBE_EVENT) return;
  odo_pose pose = {.header.struct_size = sizeof pose};
  memset(&counts, 0, sizeof counts), counts.struct_size = sizeof counts;
  memset(&error, 0, sizeof error), error.struct_size = sizeof error;
  memset(&anchor, 0, sizeof anchor), anchor.struct_size = sizeof anchor;
  EXPECT(odo.session_flush(self->session), ODO_E_STATE);
  odo.session_get_pose(self->session, ODO_TIME_LATEST, &pose);
  EXPECT(odo.session_get_statistics(self->session, &counts), ODO_OK);
  odo.session_last_error(self->session, &error);
  CHECK(odo.anchor_list(self->session, ids, 4) == 0, "there is an anchor");
  EXPECT(odo.anchor_get(self->session, 1, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, &anchor), ODO_E_NOT_FOUND);
  odo.current_plugin_call(text, sizeof text);
  ++inner_calls;
}

static void it_may_call(int run) {
  app* self = open_with_events((uint32_t)run);
  self->on_event = call_everything;
  push_rest_between(self, T0, T0 + 500 * MS);
  app_flush(self);
  EQUAL(inner_calls, 50);
}
IN_BOTH_RUNS(it_may_call, "", "'s callback may call what any thread may, but not flush", "odograph.h",
             "No lock is held: it may call [any] functions");

static int pushed_within, processed_within;
static bool run_is_live;
static void push_within(app* self, const odo_header* event) {
  if (event->type != PROBE_EVENT || pushed_within >= 20 || event->t_ns % (10 * MS) != 0) return;
  size_t before = given_count(ODO_TYPE_BAROMETER, FIXER);
  ++pushed_within;
  EXPECT(push_barometer(self, event->t_ns + MS), ODO_OK);
  processed_within += run_is_live ? 0 : given_count(ODO_TYPE_BAROMETER, FIXER) != before;
}

static void it_may_push(int run) {
  app* self = open_with_events((uint32_t)run);
  run_is_live = run == ODO_RUN_LIVE;
  self->on_event = push_within;
  push_rest_between(self, T0, T0 + SECOND);
  app_flush(self);
  app_flush(self);
  CHECK(pushed_within == 20 && given_count(ODO_TYPE_BAROMETER, FIXER) == 20,
        "%d samples were pushed within the callback and %u given; expected 20 and 20", pushed_within,
        (unsigned)given_count(ODO_TYPE_BAROMETER, FIXER));
  EQUAL(processed_within, 0);
  CHECK(journal_overlaps() == 0, "calls of one instance overlapped");
}
IN_BOTH_RUNS(it_may_push, "what ", "'s callback pushes is processed after it has returned", "odograph.h",
             "Samples that it pushes are processed after it returns.");

/* ---- which events ---- */
CASE("a null function ends the calls", "odograph.h", "With count 0 or a null function, no more calls follow") {
  static const uint32_t types[] = {ODO_TYPE_ATTITUDE, PROBE_UNDECLARED, 0x1FFF, ODO_TYPE_BAROMETER};
  app* self = app_walk(1);
  CHECK(app_events(self, ODO_TYPE_ATTITUDE) > 0 && app_events(self, ODO_TYPE_VO_MOTION) > 0, "not all events came");
  size_t before = self->count;
  EXPECT(odo.session_set_callback(self->session, types, COUNT_OF(types), NULL, NULL), ODO_OK);
  walk_second(self, 1);
  app_flush(self);
  CHECK(self->count == before, "there were calls with a null function");
}

static uint32_t strange_type;
static int wanted_calls;
static void ODO_CALL count_attitudes(void* user, const odo_header* event) {
  if (event->type != ODO_TYPE_ATTITUDE) strange_type = event->type;
  wanted_calls += *(int*)user;
}

CASE("a callback is given the events that are wanted, and none when none are", "odograph.h",
     "`types` are the wanted events (ODO_TYPE_*, vendor types too) and are copied") {
  uint32_t types[] = {ODO_TYPE_ATTITUDE, PROBE_UNDECLARED, 0x1FFF};
  int one = 1;
  hooks.on_message = walk_message;
  app* self = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
  EXPECT(odo.session_set_callback(self->session, types, COUNT_OF(types), count_attitudes, &one), ODO_OK);
  memset(types, 0, sizeof types); /* they were copied */
  walk_second(self, 0);
  app_flush(self);
  EQUAL(strange_type, 0);
  CHECK(wanted_calls > 0, "it was not called");
  wanted_calls = 0;
  types[0] = ODO_TYPE_ATTITUDE;
  EXPECT(odo.session_set_callback(self->session, types, 0, count_attitudes, &one), ODO_OK);
  walk_second(self, 1);
  app_flush(self);
  CHECK(wanted_calls == 0, "it was called although no type is wanted");
}

CASE("with the count of all events the types are not read", "odograph.h",
     "With the count ODO_ALL_EVENTS, which selects all, types is ignored.") {
  const uint32_t types[] = {ODO_TYPE_REPORT};
  int one = 1;
  hooks.on_message = walk_message;
  app* self = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
  EXPECT(odo.session_set_callback(self->session, types, ODO_ALL_EVENTS, count_attitudes, &one), ODO_OK);
  walk_second(self, 0);
  app_flush(self);
  CHECK(wanted_calls > 0 && strange_type != 0, "it was called %d times, only with attitudes: %s", wanted_calls,
        strange_type ? "no" : "yes");
}
