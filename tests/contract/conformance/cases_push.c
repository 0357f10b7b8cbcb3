/* SPDX-License-Identifier: Apache-2.0
 *
 * Type numbers of messages, unknown and vendors' ones, and inertial samples. */
#include "app.h"

#define NUMBERS "0 is none, 0x1 to 0xFFF are inputs, 0x1000 to 0x1FFF events, 0x2000 to 0x7FFFFFFF reserved"
#define UNKNOWN                                                                                                      \
  "A host orders inputs and vendor messages of unknown type by time, records them and delivers them to the plugins " \
  "that declare them."

static void refuse(app* self, uint32_t type) {
  odo_pose message; /* as large as any size tried */
  put_header(&message, sizeof message, type, T0);
  if (push(self, &message) != ODO_E_ARGUMENT)
    fail_at(__FILE__, __LINE__, "odo_session_push of type 0x%x = %s; expected ODO_E_ARGUMENT", type,
            status_name(push(self, &message)));
}

CASE("a reserved type is refused", "odograph.h", "ODO_E_ARGUMENT (type of an event or reserved type)") {
  const uint32_t types[] = {0, 0x2000, 0x10000, 0x10001, 0x1FFFF, 0x20000, 0x01000000, 0x7FFFFFFF};
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  for (size_t i = 0; i < COUNT_OF(types); ++i) refuse(self, types[i]);
  app_flush(self);
  CHECK(app_statistics(self).processed == 0, "one was processed");
}

CASE("an event's type is refused", "odograph.h", "ODO_E_ARGUMENT (type of an event or reserved type)") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  for (uint32_t type = ODO_TYPE_ATTITUDE; type <= ODO_TYPE_SURFACE; ++type) refuse(self, type);
  refuse(self, 0x1000);
  refuse(self, PROBE_NEWER_EVENT);
  refuse(self, PROBE_EVENT);
  refuse(self, 0x1FFF);
  app_flush(self);
  CHECK(app_statistics(self).processed == 0, "one was processed");
}

/* A message of `size` bytes with a pattern after its head. */
static odo_header* pattern(uint32_t size, uint32_t type, int64_t t_ns) {
  unsigned char* bytes = (unsigned char*)malloc(size);
  put_header(bytes, size, type, t_ns);
  for (uint32_t i = sizeof(odo_header); i < size; ++i) bytes[i] = (unsigned char)(i * 31 + type);
  return (odo_header*)(void*)bytes;
}

static void check_given(app* self, uint32_t size, uint32_t type) {
  odo_header* message = pattern(size, type, T0);
  FLUSHED(self, push(self, message));
  const odo_header* found = given_message(type, FIXER, 0);
  REQUIRE(found, "the plugin that declares 0x%x was not given it", type);
  CHECK(found->struct_size == size && memcmp(found, message, size) == 0,
        "0x%x of %u bytes was given with %u bytes, or others", type, size, found->struct_size);
  free(message);
}

static void vendor_message_is_given(int size) {
  check_given(app_open(FIXER_ALONE, ODO_RUN_REPLAY), (uint32_t)size, PROBE_MESSAGE);
}
CASE_OF(vendor_message_is_given, 200, "a vendor's message reaches the plugin that declares it, byte by byte", "base.h",
        UNKNOWN);
CASE_OF(vendor_message_is_given, sizeof(odo_header), "a vendor's message may be a head alone", "base.h",
        "The message starts with an odo_header, contains no pointer and has at most ODO_LARGEST_MESSAGE bytes");
CASE_OF(vendor_message_is_given, ODO_LARGEST_MESSAGE, "a vendor's message may have the largest size", "base.h",
        "The message starts with an odo_header, contains no pointer and has at most ODO_LARGEST_MESSAGE bytes");
static void newer_input_is_given(int size) {
  check_given(app_open(FIXER_ALONE, ODO_RUN_REPLAY), (uint32_t)size, PROBE_NEWER_INPUT);
}
CASE_OF(newer_input_is_given, 200, "an input of a later version reaches the plugin that declares it, byte by byte",
        "base.h", UNKNOWN);

static void too_large_is_refused(int type) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_header* message = pattern(ODO_LARGEST_MESSAGE + 8, type ? (uint32_t)type : PROBE_MESSAGE, T0);
  const int32_t status = push(self, message);
  CHECK(status < 0, "odo_session_push of %u bytes = %s", message->struct_size, status_name(status));
  app_flush(self);
  CHECK(app_statistics(self).processed == 0, "it was processed");
}
CASE_OF(too_large_is_refused, 0, "a vendor's message beyond the largest size is refused", "base.h",
        "The message starts with an odo_header, contains no pointer and has at most ODO_LARGEST_MESSAGE bytes");
CASE_OF(too_large_is_refused, ODO_TYPE_BAROMETER, "a barometer's sample beyond the largest size is refused", "base.h",
        "ODO_LARGEST_MESSAGE");

CASE("a message that no plugin declares is counted as unknown", "odograph.h",
     "samples of a type that neither the library nor any loaded plugin supports") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_header* vendors = pattern(48, PROBE_UNDECLARED, T0);
  odo_header* newer = pattern(48, 0x3F0, T0 + MS);
  EXPECT(push(self, vendors), ODO_OK);
  FLUSHED(self, push(self, newer));
  CHECK(given_count(PROBE_UNDECLARED, ANY_KIND) + given_count(0x3F0, ANY_KIND) == 0, "a plugin was given one");
  EQUAL(app_statistics(self).unknown, 2);
}

CASE("an unknown message is ordered by its time", "base.h", UNKNOWN) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_header* message = pattern(48, PROBE_MESSAGE, T0 + 10 * MS);
  const journal_entry *first, *second;
  EXPECT(push_barometer(self, T0 + 20 * MS), ODO_OK);
  FLUSHED(self, push(self, message));
  first = journal_find(PROBE_GIVEN, FIXER, 0), second = journal_find(PROBE_GIVEN, FIXER, 1);
  REQUIRE(first && second, "the plugin was not given both");
  CHECK(first->message->type == PROBE_MESSAGE && second->message->type == ODO_TYPE_BAROMETER,
        "the later one came first");
}

CASE("odo_session_push_imu pushes both sensors", "odograph.h", "Pushes an odo_imu with both sensors") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  const double gyro[3] = {0.1, 0.2, 0.3}, accel[3] = {0.5, 0.25, -9.75};
  EXPECT(odo.session_push_imu(self->session, T0, gyro, accel), ODO_OK);
  EXPECT(odo.session_push_imu(self->session, T0 + 10 * MS, gyro, accel), ODO_OK);
  app_flush(self);
  const odo_imu* found = (const odo_imu*)(const void*)given_message(ODO_TYPE_IMU, FIXER, 0);
  REQUIRE(found, "the plugin was not given the sample");
  EQUAL(found->header.flags, (ODO_IMU_GYRO | ODO_IMU_ACCEL));
  for (int i = 0; i < 3; ++i)
    CHECK(found->gyro_b[i] == gyro[i] && found->accel_b[i] == accel[i], "its values are others");
  EXPECT(odo.session_push_imu(self->session, T0 + 20 * MS, NULL, accel), ODO_E_ARGUMENT);
  EXPECT(odo.session_push_imu(self->session, T0 + 20 * MS, gyro, NULL), ODO_E_ARGUMENT);
}

static void push_half(app* self, int64_t t_ns, uint32_t flags, double value) {
  odo_imu imu;
  put_header(&imu, sizeof imu, ODO_TYPE_IMU, t_ns);
  imu.header.flags = flags;
  if (flags & ODO_IMU_GYRO) imu.gyro_b[0] = value;
  if (flags & ODO_IMU_ACCEL) imu.accel_b[2] = value;
  EXPECT(push(self, &imu), ODO_OK);
}

/* The accelerometer's samples are 4 ms after the gyroscope's; its values are -9 - time in s. */
CASE("gyroscope and accelerometer pushed apart are joined at the gyroscope's times", "samples.h",
     "host interpolates the accelerometer at the times of the gyroscope.") {
  app* self = app_open(CONFIG WITH_ATTITUDE, ODO_RUN_REPLAY);
  const odo_header* found;
  size_t whole = 0;
  for (int n = 0; n < 50; ++n) {
    push_half(self, T0 + n * 10 * MS, ODO_IMU_GYRO, 0.001 * n);
    push_half(self, T0 + n * 10 * MS + 4 * MS, ODO_IMU_ACCEL, -9 - 0.01 * n - 0.004);
  }
  app_flush(self);
  for (size_t i = 0; (found = given_message(ODO_TYPE_IMU, ATTITUDE, i)) != NULL; ++i) {
    const odo_imu* imu = (const odo_imu*)(const void*)found;
    const double expected = -9 - (double)(found->t_ns - T0) * 1e-9, off = imu->accel_b[2] - expected;
    const uint32_t both = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    CHECK((found->flags & both) == both, "an attitude was given a sample with flags 0x%x", found->flags);
    CHECK((found->t_ns - T0) % (10 * MS) == 0, "a sample is not at a gyroscope's time");
    if (found->t_ns > T0 + 10 * MS && found->t_ns < T0 + 480 * MS) {
      ++whole;
      CHECK(off < 1e-9 && off > -1e-9, "the accelerometer is off by %g where it is interpolated", off);
    }
  }
  EQUAL(whole, 46);
}

CASE("a value outside of any sensor's range is refused", "odograph.h",
     "ODO_E_DISCARD (not finite, outside the range of any sensor, late)") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  const double zero[3] = {0, 0, 0}, wild[3] = {1e6, 0, 0};
  odo_barometer sample;
  EXPECT(odo.session_push_imu(self->session, T0, wild, zero), ODO_E_DISCARD);
  EXPECT(odo.session_push_imu(self->session, T0, zero, wild), ODO_E_DISCARD);
  put_barometer(&sample, T0);
  sample.pressure_pa = 1e9;
  EXPECT(push(self, &sample), ODO_E_DISCARD);
  app_flush(self);
  CHECK(app_statistics(self).processed == 0, "one was processed");
}

CASE("an inertial spike is dropped", "odograph.h", "is dropped if the next one does not confirm it") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  const double spike[3] = {30, 0, 0}, accel[3] = {0, 0, -9.81};
  const odo_header* found;
  push_rest_between(self, T0, T0 + 100 * MS);
  EXPECT(odo.session_push_imu(self->session, T0 + 100 * MS, spike, accel), ODO_OK);
  push_rest_between(self, T0 + 110 * MS, T0 + 200 * MS);
  app_flush(self);
  EQUAL(app_statistics(self).wild, 1);
  for (size_t i = 0; (found = given_message(ODO_TYPE_IMU, ANY_KIND, i)) != NULL; ++i)
    CHECK(((const odo_imu*)(const void*)found)->gyro_b[0] < 1, "the plugin was given the spike");
}

CASE("times at the ends of the clock harm nothing", "base.h", "Times are int64_t nanoseconds of the sensor clock") {
  const int64_t times[] = {INT64_MIN, INT64_MIN + 1, INT64_MAX, INT64_MAX - 1, 0, -1, T0};
  app* self = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
  hooks.on_message = walk_message;
  for (size_t i = 0; i < COUNT_OF(times); ++i)
    for (size_t j = 0; j < sample_kind_count; ++j) {
      any_sample sample;
      sample_kinds[j].put(&sample, times[i]);
      push(self, &sample);
    }
  EXPECT(push(self, NULL), ODO_E_ARGUMENT);
  app_flush(self);
  app_close(self);
}
