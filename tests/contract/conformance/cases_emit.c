/* SPDX-License-Identifier: Apache-2.0
 *
 * Events: from which calls a plugin may emit, which ones, and how many. */
#include "app.h"

#define UNDECLARED "ODO_E_ARGUMENT for a type that neither the kind emits nor the table declares"
#define OUTSIDE "ODO_E_STATE outside process of this instance and on other threads"

typedef struct vendor_event {
  odo_header header;
  uint32_t words[8];
} vendor_event;

static void put_event(vendor_event* event, int64_t t_ns) {
  put_header(event, sizeof *event, PROBE_EVENT, t_ns);
  event->words[0] = 7;
}

/* The results of the hooks below; their plan. */
static struct {
  uint32_t within; /* the call that emits */
  int32_t status;
  int calls;
  uint32_t count, accepted, exhausted;
} plan;

/* ---- outside of process ---- */
static int64_t emit_within(probe_call* call) {
  vendor_event event;
  if (call->what != plan.within || !call->instance || !call->instance->sink) return ODO_OK;
  put_event(&event, T0);
  plan.status = probe_emit(call->instance, &event);
  ++plan.calls;
  if (call->what == PROBE_SAVE) {
    if (call->data && call->size >= 4) memcpy(call->data, "text", 4);
    return 4;
  }
  return ODO_OK;
}

static void emit_outside_process(int what) {
  char blob[4096];
  int64_t size;
  plan.within = (uint32_t)what;
  hooks.on_call = emit_within;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  if (what == PROBE_LOAD) { /* a blob to load */
    plan.within = PROBE_SAVE;
    size = odo.session_save(self->session, blob, sizeof blob);
    plan.within = PROBE_LOAD, plan.calls = 0;
    CHECK(size > 0 && size <= (int64_t)sizeof blob, "odo_session_save = %s", status_name(size));
    EXPECT(odo.session_load(self->session, blob, (uint64_t)size), ODO_OK);
  } else {
    push_rest_between(self, T0, T0 + 2 * SECOND);
    app_flush(self);
    odo.session_save(self->session, blob, sizeof blob);
    if (what == PROBE_RESET) push_set_back(self, T0 / 2, T0 / 2 + 3 * SECOND);
  }
  if (what == PROBE_DESTROY) {
    app_close(self);
  } else {
    app_flush(self);
  }
  CHECK(plan.calls > 0, "the call was not made; the calls were: %s", journal_words(FIXER));
  EXPECT(plan.status, ODO_E_STATE);
  CHECK(app_events(self, PROBE_EVENT) == 0, "the event was published");
}
CASE_OF(emit_outside_process, PROBE_ACTIVATE, "emit from activate is refused", "plugin.h", OUTSIDE);
CASE_OF(emit_outside_process, PROBE_RESET, "emit from reset is refused", "plugin.h", OUTSIDE);
CASE_OF(emit_outside_process, PROBE_SAVE, "emit from save is refused", "plugin.h", OUTSIDE);
CASE_OF(emit_outside_process, PROBE_LOAD, "emit from load is refused", "plugin.h", OUTSIDE);
CASE_OF(emit_outside_process, PROBE_DESTROY, "emit from destroy is refused", "plugin.h", OUTSIDE);

/* ---- another instance's sink, another thread ---- */
static odo_instance* instances[2];

static int32_t emit_by_other(odo_instance* instance, const odo_header* message) {
  vendor_event event;
  if (!instances[0] || instances[0] == instance) {
    instances[0] = instance;
    return ODO_OK;
  }
  put_event(&event, message->t_ns);
  plan.status = probe_emit(instances[0], &event);
  ++plan.calls;
  return ODO_OK;
}

CASE("emit of another instance within process is refused", "plugin.h", OUTSIDE) {
  hooks.on_message = emit_by_other;
  app* self = app_open(FIXER_ALONE "  - plugin: conformance/probe\n", ODO_RUN_REPLAY);
  FLUSHED(self, push_barometer(self, T0));
  CHECK(plan.calls == 1, "the two instances were not both called");
  EXPECT(plan.status, ODO_E_STATE);
  CHECK(app_events(self, PROBE_EVENT) == 0, "the event was published");
}

static void* emit_on_thread(void* instance) {
  vendor_event event;
  put_event(&event, T0);
  plan.status = probe_emit((odo_instance*)instance, &event);
  return NULL;
}

static int32_t emit_by_thread(odo_instance* instance, const odo_header* message) {
  pthread_t thread;
  if (plan.calls++ == 0 && pthread_create(&thread, NULL, emit_on_thread, instance) == 0) pthread_join(thread, NULL);
  return ODO_OK;
}

CASE("emit on another thread is refused", "plugin.h", OUTSIDE) {
  hooks.on_message = emit_by_thread;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  FLUSHED(self, push_barometer(self, T0));
  EXPECT(plan.status, ODO_E_STATE);
  CHECK(app_events(self, PROBE_EVENT) == 0, "the event was published");
}

/* ---- how many ---- */
static int32_t emit_many(odo_instance* instance, const odo_header* message) {
  if (plan.calls++ > 1) return ODO_OK;
  for (uint32_t i = 0; i < plan.count; ++i) {
    vendor_event event;
    int32_t status;
    put_event(&event, message->t_ns);
    event.words[0] = i;
    status = probe_emit(instance, &event);
    memset(&event, 0xFF, sizeof event); /* it was copied */
    plan.accepted += status == ODO_OK;
    plan.exhausted += status == ODO_E_EXHAUSTED;
  }
  return ODO_OK;
}

static app* open_and_push(int samples) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  for (int i = 0; i < samples; ++i) {
    FLUSHED(self, push_barometer(self, T0 + i * 10 * MS));
  }
  return self;
}

CASE("256 events of one call are taken, no more, and each is copied", "plugin.h",
     "ODO_E_EXHAUSTED for more than 256 events for each message of the batch") {
  plan.count = 300;
  hooks.on_message = emit_many;
  app* self = open_and_push(2);
  CHECK(plan.accepted == 2 * 256 && plan.exhausted == 2 * 44,
        "of 300 events of each of two calls %u were taken and %u answered ODO_E_EXHAUSTED; expected 512 and 88",
        plan.accepted, plan.exhausted);
  REQUIRE(app_events(self, PROBE_EVENT) == 512, "%u events were published; expected 512",
          (unsigned)app_events(self, PROBE_EVENT));
  for (size_t i = 0; i < 512; ++i) {
    const vendor_event* event = (const vendor_event*)(const void*)app_event(self, PROBE_EVENT, i);
    CHECK(event->words[0] == i % 256, "event %u has %u: it was not copied when emitted", (unsigned)i, event->words[0]);
  }
}

/* ---- which ---- */
static struct {
  odo_header header;
  unsigned char rest[2048];
} offered;

static int32_t emit_offered(odo_instance* instance, const odo_header* message) {
  if (message->type != ODO_TYPE_BAROMETER || plan.calls++ > 0) return ODO_OK;
  plan.status = instance->sink->emit(instance->sink, offered.header.struct_size == 1 ? NULL : &offered.header);
  return ODO_OK;
}

/* Makes the fixer emit what is offered. */
static app* offer(int32_t expected) {
  hooks.on_message = emit_offered;
  app* self = open_and_push(1);
  CHECK(plan.calls == 1, "the plugin was not called");
  CHECK(plan.status == expected, "emit of type 0x%x = %s; expected %s", offered.header.type, status_name(plan.status),
        status_name(expected));
  if (expected < 0) CHECK(app_events(self, offered.header.type) == 0, "the event was published");
  return self;
}

static void undeclared_type(int type) {
  put_header(&offered, sizeof offered, (uint32_t)type, T0);
  app* self = offer(ODO_E_ARGUMENT);
  CHECK(app_statistics(self).plugin_faults >= 1, "it is not counted as a fault");
}
CASE_OF(undeclared_type, ODO_TYPE_STEP, "an event that neither the kind emits nor the table declares is refused",
        "plugin.h", UNDECLARED);
CASE_OF(undeclared_type, ODO_TYPE_POSE, "a pose is not a plugin's to emit undeclared", "plugin.h", UNDECLARED);
CASE_OF(undeclared_type, ODO_TYPE_BAROMETER, "an input is not emitted", "plugin.h", UNDECLARED);
CASE_OF(undeclared_type, (int)PROBE_UNDECLARED, "a vendor's event that is not declared is refused", "plugin.h",
        UNDECLARED);

CASE("an event that the host is too old for is not supported and no fault", "plugin.h",
     "for an event that is newer than the host") {
  put_header(&offered, 64, PROBE_NEWER_EVENT, T0);
  app* self = offer(ODO_E_UNSUPPORTED);
  EQUAL(app_statistics(self).plugin_faults, 0);
}

CASE("emit of null is refused", "base.h", "the call violates the contract") {
  offered.header.struct_size = 1;
  offer(ODO_E_ARGUMENT);
}

static void too_small_event(int size) {
  put_fix((odo_fix*)(void*)&offered, T0, 1);
  offered.header.struct_size = (uint32_t)size;
  offer(ODO_E_STRUCT_SIZE);
}
CASE_OF(too_small_event, ODO_FIX_SIZE_MIN - 1, "an event one byte too small is refused", "plugin.h",
        "ODO_E_STRUCT_SIZE");
CASE_OF(too_small_event, 16, "an event smaller than a head is refused", "plugin.h", "ODO_E_STRUCT_SIZE");

CASE("a vendor's event is published with its bytes, its source and without the host's bits", "plugin.h",
     "Copies an event to the host and clears the bits of ODO_FLAG_HOST_MASK.") {
  put_header(&offered, 200, PROBE_EVENT, T0);
  offered.header.flags = ODO_FLAG_HOST_MASK | 5;
  offered.header.source = 99;
  for (uint32_t i = 0; i < 200 - sizeof(odo_header); ++i) offered.rest[i] = (unsigned char)i;
  app* self = offer(ODO_OK);
  const odo_header* found = app_event(self, PROBE_EVENT, 0);
  REQUIRE(found, "the event was not published");
  CHECK(found->struct_size == 200 &&
            memcmp((const unsigned char*)found + sizeof *found, offered.rest, 200 - sizeof *found) == 0,
        "its bytes are others");
  EQUAL(found->flags, 5);
  EQUAL(found->source, journal_find(PROBE_CREATE, FIXER, 0)->number);
}
