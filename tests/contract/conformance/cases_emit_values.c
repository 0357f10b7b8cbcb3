/* SPDX-License-Identifier: Apache-2.0
 *
 * Fields of events, and the effect of accepted events. */
#include "app.h"

#define NEEDS                                                                                                     \
  "A position requires ODO_FIX_COVARIANCE and an orientation ODO_FIX_ORIENTATION_COVARIANCE; otherwise the host " \
  "rejects it (ODO_E_ARGUMENT)."
#define FIELDS "for a field that is out of range (a report names it)"

static struct {
  odo_header header;
  unsigned char rest[2048];
} offered;
static int32_t status_of_offer;
static int offers;

static odo_fix* fix(void) { return (odo_fix*)(void*)&offered; }

static int32_t offer_with_barometer(odo_instance* instance, const odo_header* message) {
  if (message->type == ODO_TYPE_BAROMETER && strcmp(instance->kind, FIXER) == 0 && offers++ == 0) {
    offered.header.t_ns = message->t_ns;
    status_of_offer = instance->sink->emit(instance->sink, &offered.header);
    return ODO_OK;
  }
  return walk_message(instance, message);
}

/* Within a walk, so that there is a position to fix. */
static app* offer(void) {
  hooks.on_message = offer_with_barometer;
  app* self = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
  walk_second(self, 0);
  walk_second(self, 1);
  EXPECT(push_barometer(self, T0 + 1995 * MS), ODO_OK);
  walk_second(self, 2);
  app_flush(self);
  CHECK(offers == 1, "the fixer was not called");
  return self;
}

static void refuse(const char* field) {
  app* self = offer();
  EXPECT(status_of_offer, ODO_E_ARGUMENT);
  CHECK(app_events(self, ODO_TYPE_FIX) == 0, "the fix was published");
  CHECK(app_statistics(self).plugin_faults >= 1, "it is not counted as a fault");
  if (field) CHECK(app_reported(self, field), "no report names %s", field);
}

static void position_without_covariance(int bits) {
  put_fix(fix(), T0, 1);
  offered.header.flags = (uint32_t)bits;
  fix()->latitude_rad = 0.8;
  refuse(NULL);
}
CASE_OF(position_without_covariance, ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN,
        "a position fix without covariance is refused", "events.h", NEEDS);
CASE_OF(position_without_covariance, ODO_FIX_DOWN, "a fix of one component without covariance is refused", "events.h",
        NEEDS);
CASE_OF(position_without_covariance, ODO_FIX_GEODETIC, "a geodetic fix without covariance is refused", "events.h",
        NEEDS);

CASE("an orientation fix without its covariance is refused", "events.h", NEEDS) {
  put_fix(fix(), T0, 1);
  offered.header.flags = ODO_FIX_ORIENTATION;
  fix()->q_n_b[0] = 1;
  refuse(NULL);
}

static void not_finite(int which) {
  put_fix(fix(), T0, 1);
  if (which == 0) fix()->p_n[1] = (double)NAN;
  if (which == 1) fix()->covariance_n[0] = (double)INFINITY;
  if (which == 2) fix()->covariance_n[0] = -1;
  refuse(which == 0 ? "p_n" : "covariance_n");
}
CASE_OF(not_finite, 0, "a fix that is not finite is refused and its field reported", "plugin.h", FIELDS);
CASE_OF(not_finite, 1, "a fix whose covariance is not finite is refused and its field reported", "plugin.h", FIELDS);
CASE_OF(not_finite, 2, "a fix whose variance is negative is refused and its field reported", "plugin.h", FIELDS);

CASE("a fix without a unit quaternion is refused and its field reported", "plugin.h", FIELDS) {
  put_fix(fix(), T0, 1);
  offered.header.flags = ODO_FIX_ORIENTATION | ODO_FIX_ORIENTATION_COVARIANCE;
  fix()->q_n_b[0] = 3;
  for (int i = 0; i < 3; ++i) fix()->orientation_cov_n[4 * i] = 0.01;
  refuse("q_n_b");
}

/* Fields without their flag have no meaning, whatever they contain. */
CASE("fields whose bit is not set are not read", "base.h", "A value is valid if its bit in `header.flags` is set.") {
  put_fix(fix(), T0, 2);
  fix()->q_n_b[0] = fix()->yaw_rad = fix()->latitude_rad = fix()->slant_distance_m = (double)NAN;
  fix()->integrity = fix()->lever_b[0] = fix()->yaw_axis_b[2] = fix()->cross_covariance_n[3] = (double)NAN;
  app* self = offer();
  EXPECT(status_of_offer, ODO_OK);
  CHECK(app_events(self, ODO_TYPE_FIX) == 1, "the fix was not published");
}

static void accepted_is_the_hosts(int far) {
  const bool expected = !far;
  put_fix(fix(), T0, far ? 1e6 : 1.5);
  offered.header.flags |= ODO_FLAG_HOST_MASK;
  if (!far) offered.header.flags &= ~ODO_FLAG_HOST_MASK;
  app* self = offer();
  EXPECT(status_of_offer, ODO_OK);
  const odo_header* found = app_event(self, ODO_TYPE_FIX, 0);
  REQUIRE(found, "the fix was not published");
  CHECK(((found->flags & ODO_FLAG_ACCEPTED) != 0) == expected, "the published fix has flags 0x%x", found->flags);
  CHECK((found->flags & ODO_FLAG_HOST_MASK & ~ODO_FLAG_ACCEPTED) == 0, "the published fix has flags 0x%x",
        found->flags);
  CHECK(app_statistics(self).fixes_accepted == (expected ? 1 : 0) &&
            app_statistics(self).fixes_rejected == (expected ? 0 : 1),
        "fixes_accepted is %llu, fixes_rejected %llu", (unsigned long long)app_statistics(self).fixes_accepted,
        (unsigned long long)app_statistics(self).fixes_rejected);
}
CASE_OF(accepted_is_the_hosts, 0, "a fix that was used is published as accepted", "events.h",
        "On published fixes, ODO_FLAG_ACCEPTED means that the host used the fix.");
CASE_OF(accepted_is_the_hosts, 1, "a fix that was rejected is published without the bit, whatever its plugin set",
        "base.h", "Only the host sets 24 to 27");

CASE("the end of a later event is published", "base.h",
     "Of a larger one, the part beyond the known fields is forwarded unread.") {
  put_fix(fix(), T0, 1.5);
  memset(offered.rest + sizeof(odo_fix) - sizeof(odo_header), 0x3C, 40);
  offered.header.struct_size = sizeof(odo_fix) + 40;
  app* self = offer();
  EXPECT(status_of_offer, ODO_OK);
  const odo_header* found = app_event(self, ODO_TYPE_FIX, 0);
  REQUIRE(found, "the fix was not published");
  REQUIRE(found->struct_size == sizeof(odo_fix) + 40, "it was published with %u bytes; expected %u", found->struct_size,
          (unsigned)sizeof(odo_fix) + 40);
  CHECK(memcmp((const unsigned char*)found + sizeof(odo_fix), offered.rest + sizeof(odo_fix) - sizeof(odo_header),
               40) == 0,
        "its end is another");
}

/* A correction comes before the corrected pose: after it every pose is near the new track. */
CASE("a correction comes before the pose that it corrected", "events.h",
     "It is published before the first corrected pose") {
  bool corrected = false, checked = false;
  put_fix(fix(), T0, 1.5 + 3);
  fix()->covariance_n[0] = fix()->covariance_n[4] = fix()->covariance_n[8] = 1e-4;
  hooks.on_message = offer_with_barometer;
  app* self = app_open(CAMERA_WALK "coupling:\n  fix_gate: 0\n", ODO_RUN_REPLAY);
  walk_second(self, 0);
  walk_second(self, 1);
  EXPECT(push_barometer(self, T0 + 1995 * MS), ODO_OK);
  walk_second(self, 2);
  app_flush(self);
  for (size_t i = 0; i < self->count && !checked; ++i) {
    const odo_pose* pose = (const odo_pose*)(const void*)self->events[i];
    if (self->events[i]->type == ODO_TYPE_CORRECTION) corrected = true;
    if (self->events[i]->type != ODO_TYPE_POSE || !(self->events[i]->flags & ODO_POSE_POSITION)) continue;
    if (!corrected)
      CHECK(pose->p_n[0] < 3.5, "a pose %g m to the north came before the correction", pose->p_n[0]);
    else
      CHECK(pose->p_n[0] > 3.5, "the pose behind the correction is %g m to the north; the fix was at 4.5 m",
            pose->p_n[0]);
    checked = corrected;
  }
  CHECK(corrected, "there was no correction");
  CHECK(checked, "there was no pose behind the correction");
  EQUAL(given_count(ODO_TYPE_CORRECTION, FIXER), app_events(self, ODO_TYPE_CORRECTION));
}

CASE("a published motion has the orientation as the host estimates it", "events.h",
     "orientation of c0, estimated by the host; valid with ODO_FLAG_NAVIGATION") {
  app* self = app_walk(2);
  const odo_header* found = app_event(self, ODO_TYPE_VO_MOTION, 10);
  REQUIRE(found, "%u motions were published; expected more than 10", (unsigned)app_events(self, ODO_TYPE_VO_MOTION));
  CHECK(found->flags & ODO_FLAG_NAVIGATION, "a motion was published with flags 0x%x", found->flags);
  for (size_t i = 0; i < self->count; ++i)
    CHECK(self->events[i]->struct_size >= sizeof(odo_header), "event %u has %u bytes", (unsigned)i,
          self->events[i]->struct_size);
}
