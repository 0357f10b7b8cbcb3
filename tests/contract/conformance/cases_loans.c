/* SPDX-License-Identifier: Apache-2.0
 *
 * Borrowed messages: retain and release on every path of a message. */
#include "app.h"

#define BALANCE \
  "To use it longer, call retain (ODO_E_EXHAUSTED if too many are retained) and later release, once for each retain"

static void processed(int run) {
  app* self = app_open(FIXER_ALONE, (uint32_t)run);
  lent memory = NOT_LENT;
  for (int i = 0; i < 5; ++i) EXPECT(push_lent(self, &memory, T0 + i * 100 * MS), ODO_OK);
  app_flush(self);
  EQUAL(given_count(ODO_TYPE_FRAME, FIXER), 5);
  CHECK_BALANCED(&memory, 5);
}
IN_BOTH_RUNS(processed, "frames that ", " processed are released once", "base.h", BALANCE);

static void late(int unused) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  lent memory = NOT_LENT;
  push_rest_between(self, T0, T0 + 2 * SECOND);
  app_flush(self);
  EXPECT(push_lent(self, &memory, T0), ODO_E_DISCARD);
  EQUAL(app_statistics(self).late, 1);
  CHECK_BALANCED(&memory, 0);
}
CASE_OF(late, 0, "a late frame is released once", "base.h", BALANCE);

static void duplicate(int unused) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  lent first = NOT_LENT, second = NOT_LENT;
  EXPECT(push_lent(self, &first, T0), ODO_OK);
  EXPECT(push_lent(self, &second, T0), ODO_E_DISCARD);
  EQUAL(app_statistics(self).duplicate, 1);
  CHECK_BALANCED(&second, 0);
  app_flush(self);
  CHECK_BALANCED(&first, 1);
}
CASE_OF(duplicate, 0, "a frame that comes twice is released once", "base.h", BALANCE);

CASE("frames that find the queue full are released once", "base.h", BALANCE) {
  app* self = app_open(FIXER_ALONE "time_ordering:\n  queue: 64\n  frames: 64\n  max_wait: 5 s\n", ODO_RUN_REPLAY);
  lent memory = NOT_LENT;
  int refused = 0;
  push_rest_between(self, T0, T0 + 10 * MS); /* frames wait for this sensor */
  for (int i = 1; i <= 40; ++i) {            /* two messages each: more than the queue's capacity */
    int32_t status;
    push_barometer(self, T0 + i * 50 * MS);
    status = push_lent(self, &memory, T0 + i * 50 * MS);
    refused += status == ODO_E_EXHAUSTED;
    CHECK(status == ODO_OK || status == ODO_E_EXHAUSTED, "odo_session_push = %s", status_name(status));
  }
  CHECK(refused > 0, "no frame was refused");
  CHECK(app_statistics(self).overflow >= (uint64_t)refused, "overflow is %llu; expected %d at least",
        (unsigned long long)app_statistics(self).overflow, refused);
  app_flush(self);
  CHECK_BALANCED(&memory, 1);
}

CASE("more frames than may be retained are refused", "odograph.h",
     "ODO_E_EXHAUSTED (queue full, too many frames retained)") {
  app* self = app_open(FIXER_ALONE "time_ordering:\n  frames: 3\n  max_wait: 5 s\n", ODO_RUN_REPLAY);
  lent memory = NOT_LENT;
  int refused = 0;
  push_rest_between(self, T0, T0 + 10 * MS);
  for (int i = 1; i <= 10; ++i) refused += push_lent(self, &memory, T0 + i * 50 * MS) == ODO_E_EXHAUSTED;
  EQUAL(refused, 7);
  CHECK(memory.retains - memory.releases <= 3, "%d frames are retained; expected 3 at most",
        memory.retains - memory.releases);
  app_flush(self);
  CHECK_BALANCED(&memory, 3);
}

static void destroyed(int run) {
  app* self = app_open(FIXER_ALONE "time_ordering:\n  max_wait: 5 s\n", (uint32_t)run);
  lent memory = NOT_LENT;
  push_rest_between(self, T0, T0 + 10 * MS);
  for (int i = 1; i <= 5; ++i) EXPECT(push_lent(self, &memory, T0 + i * 100 * MS), ODO_OK);
  app_close(self);
  CHECK_BALANCED(&memory, 1);
}
IN_BOTH_RUNS(destroyed, "frames that wait in ", " when it is destroyed are released once", "base.h", BALANCE);

CASE("frames that wait when the clock is set back are released once", "base.h", BALANCE) {
  app* self = app_open(FIXER_ALONE "time_ordering:\n  max_wait: 5 s\n", ODO_RUN_REPLAY);
  lent memory = NOT_LENT;
  push_rest_between(self, T0, T0 + 10 * MS);
  for (int i = 1; i <= 5; ++i) EXPECT(push_lent(self, &memory, T0 + i * 100 * MS), ODO_OK);
  push_set_back(self, T0 / 2, T0 / 2 + 4 * SECOND);
  CHECK_BALANCED(&memory, 1);
}

CASE("a frame whose retain refuses is refused and never released", "base.h", BALANCE) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  lent memory = NOT_LENT;
  memory.refuse = 1;
  EXPECT(push_lent(self, &memory, T0), ODO_E_EXHAUSTED);
  app_flush(self);
  CHECK(given_count(ODO_TYPE_FRAME, ANY_KIND) == 0, "the plugin was given it");
  EQUAL(memory.releases, 0);
}

static void bad_frame(int which) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_calibration calibration;
  odo_frame frame;
  lent memory = NOT_LENT;
  put_calibration(&calibration, 0, T0);
  EXPECT(push(self, &calibration), ODO_OK);
  put_lent_frame(&frame, &memory, T0);
  if (which == 0) frame.width = 32, frame.height = 24; /* differs from the calibration's size */
  if (which == 1) frame.width = 0;
  if (which == 2) frame.planes[0].data = NULL; /* and no native memory */
  EXPECT(push(self, &frame), ODO_E_DISCARD);
  app_flush(self);
  CHECK(given_count(ODO_TYPE_FRAME, ANY_KIND) == 0, "the plugin was given it");
  CHECK_BALANCED(&memory, 0);
}
CASE_OF(bad_frame, 0, "a frame of another size than its calibration is refused and released", "base.h", BALANCE);
CASE_OF(bad_frame, 1, "a frame without width is refused and released", "base.h", BALANCE);
CASE_OF(bad_frame, 2, "a frame with neither pixels nor native memory is refused", "samples.h",
        "first pixel of the first row; null if only loan.native has the pixels");

static int32_t fail_on_frame(odo_instance* instance, const odo_header* message) {
  return message->type == ODO_TYPE_FRAME ? ODO_E_ERROR : ODO_OK;
}

CASE("frames that a plugin fails on are released once", "base.h", BALANCE) {
  lent memory = NOT_LENT;
  hooks.on_message = fail_on_frame;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  for (int i = 0; i < 5; ++i) push_lent(self, &memory, T0 + i * 100 * MS);
  app_flush(self);
  CHECK_BALANCED(&memory, 1);
}

/* ---- retain and release that push ---- */
static app* nested_app;
static int nested;
static int64_t frame_ns;

static int32_t ODO_CALL pushing_retain(void* owner) {
  push_rest(nested_app, frame_ns + ++nested * MS);
  return ODO_OK;
}

static void ODO_CALL pushing_release(void* owner) { push_rest(nested_app, frame_ns + ++nested * MS); }

static void they_may_push(int run) {
  odo_frame frame;
  nested_app = app_open(FIXER_ALONE, (uint32_t)run);
  for (int i = 0; i < 3; ++i) {
    frame_ns = T0 + i * SECOND;
    put_frame(&frame, 0, frame_ns);
    frame.loan.retain = pushing_retain, frame.loan.release = pushing_release;
    EXPECT(push(nested_app, &frame), ODO_OK);
  }
  app_flush(nested_app);
  CHECK(nested >= 6, "retain and release were called %d times; expected 6", nested);
  app_close(nested_app);
}
IN_BOTH_RUNS(they_may_push, "retain and release of ", " may push", "odograph.h",
             "No lock is held while retain or release is called: they may push.");

/* ---- other borrowed messages ---- */
static void put_borrowed(odo_borrowed* message, lent* of, uint32_t type) {
  put_header(message, sizeof *message, type, T0);
  lend(&message->loan, of);
}

static const void* native_seen;

static int32_t ask_native(odo_instance* instance, const odo_header* message) {
  const odo_borrowed* borrowed = (const odo_borrowed*)(const void*)message;
  if (ODO_IS_BORROWED(message->type) && borrowed->loan.native)
    native_seen =
        borrowed->loan.native(borrowed->loan.owner, ODO_NATIVE_HARDWARE_BUFFER, sizeof ODO_NATIVE_HARDWARE_BUFFER - 1);
  return ODO_OK;
}

static void unknown_borrowed(int type) {
  odo_borrowed message;
  lent memory = NOT_LENT;
  memory.native = &memory;
  hooks.on_message = ask_native;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  put_borrowed(&message, &memory, (uint32_t)type);
  EXPECT(push(self, &message), ODO_OK);
  CHECK(memory.retains == 1 || memory.releases == 1, "the message was neither processed nor retained");
  memset(&message, 0xFF, sizeof message);
  app_flush(self);
  CHECK(given_count((uint32_t)type, FIXER) == 1, "the plugin was not given it");
  CHECK(native_seen == &memory, "its memory was not given on");
  CHECK_BALANCED(&memory, 1);
}
CASE_OF(unknown_borrowed, PROBE_NEWER_BORROWED,
        "a later borrowed input is retained and reaches the plugin that declares it", "base.h",
        "so that a host can retain messages of unknown type");
CASE_OF(unknown_borrowed, (int)PROBE_BORROWED,
        "a vendor's borrowed message is retained and reaches the plugin that declares it", "base.h",
        "With number & ODO_BORROWED it starts with an odo_borrowed");

static void unknown_borrowed_without_retain(int type) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_borrowed message;
  lent memory = NOT_LENT;
  put_borrowed(&message, &memory, (uint32_t)type);
  message.loan.retain = NULL;
  EXPECT(push(self, &message), ODO_E_UNSUPPORTED);
  message.loan.release = NULL;
  EXPECT(push(self, &message), ODO_E_UNSUPPORTED);
  app_flush(self);
  CHECK(given_count((uint32_t)type, ANY_KIND) == 0, "the plugin was given it");
}
CASE_OF(unknown_borrowed_without_retain, PROBE_NEWER_BORROWED,
        "a later borrowed input without retain or release is not supported", "odograph.h",
        "Any other borrowed message must have retain and release (ODO_E_UNSUPPORTED)");
CASE_OF(unknown_borrowed_without_retain, (int)PROBE_BORROWED,
        "a vendor's borrowed message without retain or release is not supported", "odograph.h",
        "Any other borrowed message must have retain and release (ODO_E_UNSUPPORTED)");

CASE("a borrowed message that no plugin declares is released", "base.h", BALANCE) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_borrowed message;
  lent memory = NOT_LENT;
  put_borrowed(&message, &memory, PROBE_BORROWED_UNDECLARED);
  push(self, &message);
  app_flush(self);
  CHECK(given_count(PROBE_BORROWED_UNDECLARED, ANY_KIND) == 0, "the plugin was given it");
  CHECK_BALANCED(&memory, 0);
}

CASE("a borrowed message that ends before its loan is refused", "base.h",
     "First members of every message whose type has the bit ODO_BORROWED.") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_borrowed message;
  lent memory = NOT_LENT;
  put_borrowed(&message, &memory, PROBE_BORROWED);
  message.header.struct_size = sizeof(odo_header);
  EXPECT(push(self, &message), ODO_E_STRUCT_SIZE);
  message.header.struct_size = sizeof(odo_borrowed) - 1;
  EXPECT(push(self, &message), ODO_E_STRUCT_SIZE);
  CHECK(memory.retains == 0, "retain was called out of a struct that does not hold it");
}
