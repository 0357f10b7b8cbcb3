/* SPDX-License-Identifier: Apache-2.0
 *
 * Time order: between sensors, late and repeated samples, clocks set back. */
#include "app.h"

#define ANY_ORDER \
  "Samples of different sensors may arrive in any order within the configured wait (time_ordering.max_wait)."

static int32_t push_magnetometer(app* self, int64_t t_ns) {
  odo_magnetometer sample;
  sample_kinds[1].put(&sample, t_ns);
  return push(self, &sample);
}

static void check_times_rise(void) {
  int64_t before = INT64_MIN;
  const journal_entry* entry;
  for (size_t i = 0; (entry = journal_find(PROBE_GIVEN, FIXER, i)) != NULL; ++i) {
    CHECK(entry->message->t_ns >= before, "message %u was given after a later one", (unsigned)i);
    before = entry->message->t_ns;
  }
}

/* For each inertial sample one of the kind arrives 100 ms later; the session waits 200 ms. */
static void lagging_is_taken(app* self, const sample_kind* kind) {
  any_sample sample;
  unsigned dropped = 0;
  for (int i = 0; i < 200; ++i) {
    EXPECT(push_rest(self, T0 + i * 10 * MS), ODO_OK);
    if (i < 10) continue;
    kind->put(&sample, T0 + (i - 10) * 10 * MS + MS);
    dropped += push(self, &sample) != ODO_OK;
  }
  app_flush(self);
  CHECK(dropped <= 10, "of 190 samples that came 0.1 s behind the inertial ones %u were dropped; 0.2 s are waited",
        dropped);
  EQUAL(given_count(kind->type, FIXER), 190 - dropped);
}

static void sensor_may_lag(int index) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  lagging_is_taken(self, &sample_kinds[index]);
}
CASE_OF(sensor_may_lag, 1, "a magnetometer may lag behind the others by less than the wait", "odograph.h", ANY_ORDER);
CASE_OF(sensor_may_lag, 2, "a barometer may lag behind the others by less than the wait", "odograph.h", ANY_ORDER);
CASE_OF(sensor_may_lag, 3, "a satellite receiver may lag behind the others by less than the wait", "odograph.h",
        ANY_ORDER);
CASE_OF(sensor_may_lag, 8, "a platform's poses may lag behind the others by less than the wait", "odograph.h",
        ANY_ORDER);
CASE_OF(sensor_may_lag, 9, "ranges may lag behind the others by less than the wait", "odograph.h", ANY_ORDER);
CASE_OF(sensor_may_lag, 10, "a platform's steps may lag behind the others by less than the wait", "odograph.h",
        ANY_ORDER);

CASE("a camera may lag behind the others by less than the wait", "odograph.h", ANY_ORDER) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  unsigned dropped = 0;
  odo_frame frame;
  for (int i = 0; i < 200; ++i) {
    EXPECT(push_rest(self, T0 + i * 10 * MS), ODO_OK);
    put_frame(&frame, 0, T0 + (i - 10) * 10 * MS + MS);
    if (i >= 10 && i % 5 == 0) dropped += push(self, &frame) != ODO_OK;
  }
  app_flush(self);
  CHECK(dropped <= 2, "of 38 frames that came 0.1 s behind the inertial samples %u were dropped; 0.2 s are waited",
        dropped);
  check_times_rise();
}

static void pairs_are_ordered(int run) {
  app* self = app_open(FIXER_ALONE, (uint32_t)run);
  for (int i = 0; i < 100; ++i) {
    EXPECT(push_magnetometer(self, T0 + i * 10 * MS + 2 * MS), ODO_OK);
    EXPECT(push_rest(self, T0 + i * 10 * MS), ODO_OK);
  }
  app_flush(self);
  CHECK(given_count(ODO_TYPE_IMU, FIXER) == 100 && given_count(ODO_TYPE_MAGNETOMETER, FIXER) == 100,
        "%u and %u samples were given; expected 100 of each", (unsigned)given_count(ODO_TYPE_IMU, FIXER),
        (unsigned)given_count(ODO_TYPE_MAGNETOMETER, FIXER));
  check_times_rise();
}
IN_BOTH_RUNS(pairs_are_ordered, "two sensors are put in order in ", "", "plugin.h", "Messages in time order;");

CASE("a sample of a time that was processed is discarded as late", "odograph.h",
     "dropped: arrived after its time had been processed") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  push_rest_between(self, T0, T0 + SECOND);
  app_flush(self);
  EXPECT(push_barometer(self, T0 + 500 * MS), ODO_E_DISCARD);
  EQUAL(app_statistics(self).late, 1);
  app_flush(self);
  CHECK(given_count(ODO_TYPE_BAROMETER, ANY_KIND) == 0, "the plugin was given it");
  EXPECT(push_barometer(self, T0 + 1100 * MS), ODO_OK);
}

CASE("a sample of the same sensor and time is dropped", "odograph.h",
     "dropped: same sensor and time as an earlier one") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  EXPECT(push_barometer(self, T0), ODO_OK);
  EXPECT(push_barometer(self, T0), ODO_E_DISCARD);
  EXPECT(push_magnetometer(self, T0), ODO_OK); /* another sensor */
  EQUAL(app_statistics(self).duplicate, 1);
  app_flush(self);
  CHECK(given_count(ODO_TYPE_BAROMETER, FIXER) == 1 && given_count(ODO_TYPE_MAGNETOMETER, FIXER) == 1,
        "the plugin was given %u and %u samples; expected one of each",
        (unsigned)given_count(ODO_TYPE_BAROMETER, FIXER), (unsigned)given_count(ODO_TYPE_MAGNETOMETER, FIXER));
}

CASE("messages of two sources are of two sensors", "base.h", "input: number of the sensor") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_header message;
  for (uint32_t source = 0; source < 2; ++source) {
    put_header(&message, sizeof message, PROBE_MESSAGE, T0);
    message.source = source;
    EXPECT(push(self, &message), ODO_OK);
  }
  app_flush(self);
  EQUAL(given_count(PROBE_MESSAGE, FIXER), 2);
}

static void second_sensor(int type) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_barometer pressure;
  odo_imu turned;
  put_header(&turned.header, sizeof turned, ODO_TYPE_IMU, T0);
  turned.header.flags = ODO_IMU_GYRO, turned.header.source = 3;
  memset(turned.gyro_b, 0, sizeof turned.gyro_b), memset(turned.accel_b, 0, sizeof turned.accel_b);
  put_header(&pressure.header, sizeof pressure, ODO_TYPE_BAROMETER, T0);
  pressure.header.source = 3, pressure.pressure_pa = 1e5, pressure.sigma_pa = 0;
  if (type == ODO_TYPE_IMU) {
    EXPECT(push(self, &turned), ODO_OK);
    turned.header.source = 0, turned.header.t_ns += MS;
    EXPECT(push(self, &turned), ODO_E_UNSUPPORTED);
    turned.header.flags = ODO_IMU_ACCEL; /* another sensor */
    EXPECT(push(self, &turned), ODO_OK);
  } else {
    EXPECT(push(self, &pressure), ODO_OK);
    pressure.header.source = 0, pressure.header.t_ns += MS;
    EXPECT(push(self, &pressure), ODO_E_UNSUPPORTED);
  }
}
CASE_OF(second_sensor, ODO_TYPE_IMU, "a second gyroscope is refused", "samples.h",
        "the host takes the first that delivers, and refuses the others");
CASE_OF(second_sensor, ODO_TYPE_BAROMETER, "a second barometer is refused", "samples.h",
        "the host takes the first that delivers, and refuses the others");

static void flush_processes_all(int run) {
  app* self = app_open(FIXER_ALONE "time_ordering:\n  max_wait: 5 s\n", (uint32_t)run);
  push_rest_between(self, T0, T0 + 20 * MS);
  FLUSHED(self, push_barometer(self, T0 + SECOND));
  CHECK(given_count(ODO_TYPE_BAROMETER, FIXER) == 1, "after odo_session_flush the newest sample was not given");
  EQUAL(app_statistics(self).processed, 3);
}
IN_BOTH_RUNS(flush_processes_all, "a flush of ", " processes all", "odograph.h",
             "Processes all pushed samples without waiting for slower sensors");

static void set_back(app* self) {
  odo_calibration calibration;
  odo_header map;
  put_calibration(&calibration, 0, T0);
  EXPECT(push(self, &calibration), ODO_OK);
  put_header(&map, sizeof map, PROBE_MESSAGE, T0);
  map.flags = ODO_FLAG_DESCRIPTION;
  EXPECT(push(self, &map), ODO_OK);
  map.flags = 0, map.source = 1;
  EXPECT(push(self, &map), ODO_OK);
  push_rest_between(self, T0, T0 + 2 * SECOND);
  app_flush(self);
  journal_clear();
  push_set_back(self, T0 / 2 + 5 * SECOND, T0 / 2 + 8 * SECOND);
}

CASE("plugins are reset when the clock is set back, and calibrations come again", "plugin.h",
     "the host sends descriptions again (ODO_FLAG_DESCRIPTION).") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  set_back(self);
  const journal_entry* first = journal_find(PROBE_RESET, FIXER, 0);
  CHECK(first, "the plugin was not reset; its calls were: %s", journal_words(FIXER));
  CHECK(journal_count(PROBE_CREATE, FIXER) == 0, "a new instance was made of a plugin that can be reset");
  EQUAL(given_count(ODO_TYPE_CALIBRATION, FIXER), 1);
  EQUAL(given_count(PROBE_MESSAGE, FIXER), 1);
  const odo_header* newest = given_message(ODO_TYPE_IMU, FIXER, 200);
  CHECK(newest && newest->t_ns > T0 / 2 && newest->t_ns < T0, "samples of the new clock were not given");
}

CASE("a plugin without reset is made anew when the clock is set back", "plugin.h",
     "If it is null, the host creates a new instance.") {
  app* self = app_open(CONFIG WITH_ATTITUDE "vo_frontend:\n  plugin: conformance/bare\n", ODO_RUN_REPLAY);
  set_back(self);
  CHECK(journal_count(PROBE_CREATE, FRONTEND) == 1 && journal_count(PROBE_CONFIGURE, FRONTEND) == 1 &&
            journal_count(PROBE_ACTIVATE, FRONTEND) == 1 && journal_count(PROBE_DESTROY, FRONTEND) == 1,
        "there was not one new instance; its calls were: %s", journal_words(FRONTEND));
  EQUAL(given_count(ODO_TYPE_CALIBRATION, FRONTEND), 1);
}

CASE("each sample is in one batch", "plugin.h", "Messages in time order;") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  const journal_entry* entry;
  size_t given = 0;
  push_rest_between(self, T0, T0 + 500 * MS);
  app_flush(self);
  for (size_t i = 0; (entry = journal_find(PROBE_PROCESS, FIXER, i)) != NULL; ++i) {
    CHECK(entry->size > 0, "a batch is empty although nothing asked to be called");
    given += entry->size;
  }
  EQUAL(given, 50);
}

static const void* batch_fault;
static int64_t look_at_batch(probe_call* call) {
  if (call->what == PROBE_PROCESS && (call->batch->struct_size < ODO_BATCH_SIZE_MIN || !call->batch->messages))
    batch_fault = "struct_size or messages";
  if (call->what == PROBE_ACTIVATE && (call->instance->sink->struct_size < ODO_SINK_SIZE_MIN ||
                                       call->instance->sink->instance != call->instance->number))
    batch_fault = "the sink";
  if (call->what == PROBE_CONFIGURE &&
      (call->size < ODO_VALUE_SIZE_MIN || call->values->struct_size < ODO_VALUE_SIZE_MIN))
    batch_fault = "the values";
  if (call->what == PROBE_ENTRY && (((odo_plugin*)call->data)->struct_size < ODO_PLUGIN_SIZE_MIN ||
                                    call->host->struct_size < ODO_HOST_SIZE_MIN || !call->host->version.size))
    batch_fault = "the host or the table";
  return ODO_OK;
}

CASE("what a plugin is given has at least the sizes of 1.0", "base.h", "It starts with `uint32_t struct_size`.") {
  hooks.on_call = look_at_batch;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  push_rest_between(self, T0, T0 + 100 * MS);
  app_flush(self);
  CHECK(!batch_fault, "a plugin's struct is wrong: %s", (const char*)batch_fault);
}
