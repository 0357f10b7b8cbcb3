/* SPDX-License-Identifier: Apache-2.0
 *
 * Push of each type of copied input. */
#include "app.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LATER 40u /* size of a later version's extension */

static union {
  odo_header header;
  unsigned char bytes[LARGEST_SAMPLE];
} sample;

static void put_sample(const sample_kind* kind, int64_t t_ns, uint32_t size) {
  memset(&sample, 0, sizeof sample);
  kind->put(&sample, t_ns);
  for (uint32_t i = kind->size; i < size; ++i) sample.bytes[i] = (unsigned char)(i * 7 + 1);
  sample.header.struct_size = size;
}

/* An inertial sample is joined with its neighbours and checked for spikes against them, so it is pushed among others.
 */
static int32_t push_among_others(app* self, const sample_kind* kind) {
  if (kind->type != ODO_TYPE_IMU) return push(self, &sample);
  push_rest_between(self, T0 - 50 * MS, T0);
  int32_t status = push(self, &sample);
  push_rest_between(self, T0 + 10 * MS, T0 + 50 * MS);
  return status;
}

/* The fixer's input at T0; ends the case if there is none. */
static const odo_header* given_at_t0(const sample_kind* kind) {
  const odo_header* found;
  for (size_t i = 0; (found = given_message(kind->type, FIXER, i)) != NULL; ++i)
    if (found->t_ns == T0) return found;
  REQUIRE(found, "the plugin was not given the %s", kind->name);
  return found;
}

static void taken_at_1_0(int index) {
  const sample_kind* kind = &sample_kinds[index];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  put_sample(kind, T0, kind->min_size);
  sample.header.flags |= ODO_FLAG_QUALITY;
  sample.header.quality = 0.5f;
  sample.header.source = 3;
  if (kind->type == ODO_TYPE_IMU) sample.header.source = 0, sample.header.flags &= ~ODO_FLAG_QUALITY;
  EXPECT(push_among_others(self, kind), ODO_OK);
  app_flush(self);
  const odo_header* found = given_at_t0(kind);
  REQUIRE(found->struct_size >= kind->min_size, "it was given with %u bytes", found->struct_size);
  CHECK(found->flags == sample.header.flags && found->source == sample.header.source,
        "it was given with flags 0x%x and source %u; expected 0x%x and %u", found->flags, found->source,
        sample.header.flags, sample.header.source);
  if (kind->type != ODO_TYPE_IMU)
    CHECK(found->quality == 0.5f, "its quality is %g; expected 0.5", (double)found->quality);
  CHECK(memcmp(found + 1, sample.bytes + sizeof *found, kind->min_size - sizeof *found) == 0, "its values are others");
}

static void too_small_is_refused(int index) {
  const sample_kind* kind = &sample_kinds[index];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  const uint32_t sizes[] = {0, 8, sizeof(odo_header), kind->min_size - 8, kind->min_size - 1};
  for (size_t i = 0; i < COUNT_OF(sizes); ++i) {
    put_sample(kind, T0 + (int64_t)i * MS, kind->size);
    sample.header.struct_size = sizes[i];
    expect_status(__FILE__, __LINE__, "odo_session_push", push(self, &sample), ODO_E_STRUCT_SIZE);
  }
  app_flush(self);
  CHECK(given_count(kind->type, ANY_KIND) == 0, "a plugin was given one");
  CHECK(app_statistics(self).processed == 0, "one was processed");
}

static void later_end_is_passed_on(int index) {
  const sample_kind* kind = &sample_kinds[index];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  put_sample(kind, T0, kind->size + LATER);
  EXPECT(push_among_others(self, kind), ODO_OK);
  app_flush(self);
  const odo_header* found = given_at_t0(kind);
  REQUIRE(found->struct_size == kind->size + LATER, "it was given with %u bytes; expected %u", found->struct_size,
          kind->size + LATER);
  CHECK(memcmp((const unsigned char*)found + kind->size, sample.bytes + kind->size, LATER) == 0, "its end is another");
}

/* The host's own struct, as docs/abi.md specifies; but it is accepted. */
static void later_inertial_sample_is_taken(int unused) {
  const sample_kind* kind = &sample_kinds[0];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  put_sample(kind, T0, kind->size + LATER);
  EXPECT(push_among_others(self, kind), ODO_OK);
  app_flush(self);
  given_at_t0(kind);
}

static void not_finite_is_refused(int index) {
  const sample_kind* kind = &sample_kinds[index];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  const double wrong[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
  for (size_t i = 0; i < COUNT_OF(wrong); ++i) {
    odo_statistics counts;
    put_sample(kind, T0 + (int64_t)i * MS, kind->size);
    memcpy(sample.bytes + kind->number_at, &wrong[i], sizeof wrong[i]);
    expect_status(__FILE__, __LINE__, "odo_session_push", push(self, &sample), ODO_E_DISCARD);
    counts = app_statistics(self);
    EQUAL(counts.invalid, i + 1);
  }
  app_flush(self);
  CHECK(given_count(kind->type, ANY_KIND) == 0, "a plugin was given one");
}

static void host_bits_are_cleared(int index) {
  const sample_kind* kind = &sample_kinds[index];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  put_sample(kind, T0, kind->size);
  sample.header.flags |= ODO_FLAG_HOST_MASK;
  EXPECT(push_among_others(self, kind), ODO_OK);
  app_flush(self);
  const odo_header* found = given_at_t0(kind);
  CHECK((found->flags & ODO_FLAG_HOST_MASK) == 0, "it was given with flags 0x%x", found->flags);
}

/* A bit of a later version, below the host's own. */
static void unknown_bits_are_passed_on(int index) {
  const sample_kind* kind = &sample_kinds[index];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  put_sample(kind, T0, kind->size);
  sample.header.flags |= 0x00800000u;
  EXPECT(push_among_others(self, kind), ODO_OK);
  app_flush(self);
  CHECK(given_at_t0(kind)->flags & 0x00800000u, "it was given with flags 0x%x", given_at_t0(kind)->flags);
}

static void struct_is_copied(int index) {
  const sample_kind* kind = &sample_kinds[index];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  unsigned char pushed[LARGEST_SAMPLE];
  put_sample(kind, T0, kind->size);
  memcpy(pushed, &sample, sizeof pushed);
  EXPECT(push(self, &sample), ODO_OK);
  memset(&sample, 0xFF, sizeof sample);
  app_flush(self);
  CHECK(memcmp(given_at_t0(kind) + 1, pushed + sizeof(odo_header), kind->min_size - sizeof(odo_header)) == 0,
        "its values were read after the push");
}

#define TAKEN "Adds an input of samples.h or a vendor message, with struct_size and type set."
#define BASE(index, name)                                                                                           \
  {name " of version 1.0's size is taken and given to the plugin", "odograph.h", TAKEN, taken_at_1_0, index},       \
      {name " that is too small is refused", "base.h", "A struct smaller than in version 1.0 is rejected.",         \
       too_small_is_refused, index},                                                                                \
      {name " with a number that is not finite is refused", "odograph.h",                                           \
       "ODO_E_DISCARD (not finite, outside the range of any sensor, late)", not_finite_is_refused, index},          \
      {"the host's bits are cleared on " name, "odograph.h", "bits of ODO_FLAG_HOST_MASK are cleared",              \
       host_bits_are_cleared, index},                                                                               \
  {                                                                                                                 \
    "an unknown bit of " name " is passed on", "base.h", "Bits of header.flags: 0 to 23 are specific to the type.", \
        unknown_bits_are_passed_on, index                                                                           \
  }
#define COPIED(index, name)                                                                                  \
  {"the end of a later " name " is passed on", "base.h",                                                     \
   "Of a larger one, the part beyond the known fields is forwarded unread.", later_end_is_passed_on, index}, \
  {                                                                                                          \
    name " is copied by its push", "odograph.h", "The struct is copied", struct_is_copied, index             \
  }

const conformance_case cases_types[] = {
    BASE(0, "odo_imu"),
    {"a later odo_imu is taken", "base.h", "Of a larger one, the part beyond the known fields is forwarded unread.",
     later_inertial_sample_is_taken, 0},
    BASE(1, "odo_magnetometer"),
    COPIED(1, "odo_magnetometer"),
    BASE(2, "odo_barometer"),
    COPIED(2, "odo_barometer"),
    BASE(3, "odo_gnss"),
    COPIED(3, "odo_gnss"),
    BASE(4, "odo_calibration"),
    COPIED(4, "odo_calibration"),
    BASE(5, "odo_imu_noise"),
    COPIED(5, "odo_imu_noise"),
    BASE(6, "odo_waypoint"),
    COPIED(6, "odo_waypoint"),
    BASE(7, "odo_earth_field"),
    COPIED(7, "odo_earth_field"),
    BASE(8, "odo_platform_pose"),
    COPIED(8, "odo_platform_pose"),
    BASE(9, "odo_range"),
    COPIED(9, "odo_range"),
    BASE(10, "odo_system_step"),
    COPIED(10, "odo_system_step"),
    {NULL, NULL, NULL, NULL, 0}};
