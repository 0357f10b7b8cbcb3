/* SPDX-License-Identifier: Apache-2.0
 *
 * Push of each type of copied input. */
#include "app.h"

#define LATER 40u /* size of a later version's extension */

static any_sample sample;

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

/* Pushes the sample and returns the fixer's input. */
static const odo_header* given_after_push(const sample_kind* kind) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  FLUSHED(self, push_among_others(self, kind));
  return given_at_t0(kind);
}

static void taken_at_1_0(int index) {
  const sample_kind* kind = &sample_kinds[index];
  put_sample(kind, T0, kind->min_size);
  sample.header.flags |= ODO_FLAG_QUALITY;
  sample.header.quality = 0.5f;
  sample.header.source = 3;
  if (kind->type == ODO_TYPE_IMU) sample.header.source = 0, sample.header.flags &= ~ODO_FLAG_QUALITY;
  const odo_header* found = given_after_push(kind);
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
  put_sample(kind, T0, kind->size + LATER);
  const odo_header* found = given_after_push(kind);
  if (kind->type == ODO_TYPE_IMU) return; /* joined, it is the host's own struct (docs/abi.md) */
  REQUIRE(found->struct_size == kind->size + LATER, "it was given with %u bytes; expected %u", found->struct_size,
          kind->size + LATER);
  CHECK(memcmp((const unsigned char*)found + kind->size, sample.bytes + kind->size, LATER) == 0, "its end is another");
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

static uint32_t flags_given(int index, uint32_t flags) {
  put_sample(&sample_kinds[index], T0, sample_kinds[index].size);
  sample.header.flags |= flags;
  return given_after_push(&sample_kinds[index])->flags;
}

static void host_bits_are_cleared(int index) {
  const uint32_t flags = flags_given(index, ODO_FLAG_HOST_MASK);
  CHECK((flags & ODO_FLAG_HOST_MASK) == 0, "it was given with flags 0x%x", flags);
}

/* A bit of a later version, below the host's own. */
static void unknown_bits_are_passed_on(int index) {
  const uint32_t flags = flags_given(index, 0x00800000u);
  CHECK(flags & 0x00800000u, "it was given with flags 0x%x", flags);
}

static void struct_is_copied(int index) {
  const sample_kind* kind = &sample_kinds[index];
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  put_sample(kind, T0, kind->size);
  const any_sample pushed = sample;
  EXPECT(push(self, &sample), ODO_OK);
  memset(&sample, 0xFF, sizeof sample);
  app_flush(self);
  CHECK(memcmp(given_at_t0(kind) + 1, pushed.bytes + sizeof(odo_header), kind->min_size - sizeof(odo_header)) == 0,
        "its values were read after the push");
}

#define TAKEN "Adds an input of samples.h or a vendor message, with struct_size and type set."
#define INPUT(index, name, end)                                                                                      \
  CASE_OF(taken_at_1_0, index, name " of version 1.0's size is taken and given to the plugin", "odograph.h", TAKEN); \
  CASE_OF(too_small_is_refused, index, name " that is too small is refused", "base.h",                               \
          "A struct smaller than in version 1.0 is rejected.");                                                      \
  CASE_OF(not_finite_is_refused, index, name " with a number that is not finite is refused", "odograph.h",           \
          "ODO_E_DISCARD (not finite, outside the range of any sensor, late)");                                      \
  CASE_OF(host_bits_are_cleared, index, "the host's bits are cleared on " name, "odograph.h",                        \
          "bits of ODO_FLAG_HOST_MASK are cleared");                                                                 \
  CASE_OF(unknown_bits_are_passed_on, index, "an unknown bit of " name " is passed on", "base.h",                    \
          "Bits of header.flags: 0 to 23 are specific to the type.");                                                \
  CASE_OF(later_end_is_passed_on, index, "a later " name " is taken" end, "base.h",                                  \
          "Of a larger one, the part beyond the known fields is forwarded unread.");                                 \
  CASE_OF(struct_is_copied, index, name " is copied by its push", "odograph.h", "The struct is copied")
INPUT(0, "odo_imu", "");
INPUT(1, "odo_magnetometer", " with its end");
INPUT(2, "odo_barometer", " with its end");
INPUT(3, "odo_gnss", " with its end");
INPUT(4, "odo_calibration", " with its end");
INPUT(5, "odo_imu_noise", " with its end");
INPUT(6, "odo_waypoint", " with its end");
INPUT(7, "odo_earth_field", " with its end");
INPUT(8, "odo_platform_pose", " with its end");
INPUT(9, "odo_range", " with its end");
INPUT(10, "odo_system_step", " with its end");
