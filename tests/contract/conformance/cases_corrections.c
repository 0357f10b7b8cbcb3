/* SPDX-License-Identifier: Apache-2.0
 *
 * What a correction of the track moves: stored poses and anchors, but no smooth pose. */
#include "app.h"

#define MOMENTS 4 /* times at which poses are compared */
static const int64_t moments[MOMENTS] = {T0 + 1040 * MS, T0 + 2000 * MS, T0 + 2830 * MS, T0 + 2990 * MS};

typedef struct view {
  odo_pose corrected, smooth;
  odo_anchor anchor;
} view;

static odo_pose pose_in(app* self, uint32_t world, int64_t t_ns) {
  odo_pose pose = {.header.struct_size = sizeof pose};
  EXPECT(odo.session_get_pose_of(self->session, ODO_OF_PIPELINE, world, t_ns, &pose), ODO_OK);
  return pose;
}

static void look(app* self, uint64_t anchor, view* views) {
  for (int i = 0; i < MOMENTS; ++i) {
    views[i].corrected = pose_in(self, ODO_WORLD_CORRECTED, moments[i]);
    views[i].smooth = pose_in(self, ODO_WORLD_SMOOTH, moments[i]);
    memset(&views[i].anchor, 0, sizeof views[i].anchor);
    views[i].anchor.struct_size = sizeof views[i].anchor;
    EXPECT(odo.anchor_get(self->session, anchor, ODO_WORLD_CORRECTED, moments[i], &views[i].anchor), ODO_OK);
  }
}

/* The rotation of v by a unit quaternion w, x, y, z. */
static void rotate(const double* q, const double* v, double* out) {
  double t[3];
  for (int i = 0; i < 3; ++i) t[i] = 2 * (q[1 + (i + 1) % 3] * v[(i + 2) % 3] - q[1 + (i + 2) % 3] * v[(i + 1) % 3]);
  for (int i = 0; i < 3; ++i)
    out[i] = v[i] + q[0] * t[i] + q[1 + (i + 1) % 3] * t[(i + 2) % 3] - q[1 + (i + 2) % 3] * t[(i + 1) % 3];
}

static double apart(const double* a, const double* b) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return sqrt(x * x + y * y + z * z);
}

/* A walk of three seconds with an anchor seen after two, corrected by a fix 3 m beside its end. */
static odo_correction corrected_walk(view* before, view* after) {
  odo_barometer trigger;
  uint64_t anchor = 0;
  app* self = app_walk(3);
  odo_anchor_place place = {.struct_size = sizeof place};
  place.kind = ODO_ANCHOR_VIEW;
  place.t_ns = moments[1];
  place.p[2] = 4;
  EXPECT(odo.anchor_create(self->session, &place, &anchor), ODO_OK);
  look(self, anchor, before);
  put_fix(&walk_fix, moments[3], before[3].corrected.p_n[0]);
  walk_fix.p_n[1] = before[3].corrected.p_n[1] + 3;
  walk_fix.p_n[2] = before[3].corrected.p_n[2];
  put_barometer(&trigger, moments[3]);
  FLUSHED(self, push(self, &trigger));
  REQUIRE(app_events(self, ODO_TYPE_CORRECTION) == 1, "the fix gave %u corrections; expected 1",
          (unsigned)app_events(self, ODO_TYPE_CORRECTION));
  look(self, anchor, after);
  return *(const odo_correction*)app_event(self, ODO_TYPE_CORRECTION, 0);
}

CASE("a correction moves the stored poses", "odograph.h",
     "in today's n: with each correction (odo_correction) the stored poses move.") {
  view before[MOMENTS], after[MOMENTS];
  const odo_correction correction = corrected_walk(before, after);
  for (int i = 0; i < MOMENTS; ++i) {
    double expected[3];
    rotate(correction.q_n, before[i].corrected.p_n, expected);
    for (int k = 0; k < 3; ++k) expected[k] += correction.p_n[k];
    CHECK(apart(before[i].corrected.p_n, after[i].corrected.p_n) > 2, "pose %d moved by only %g m", i,
          apart(before[i].corrected.p_n, after[i].corrected.p_n));
    CHECK(apart(expected, after[i].corrected.p_n) < 1e-6, "pose %d is %g m from the old one, corrected", i,
          apart(expected, after[i].corrected.p_n));
  }
}

CASE("a correction moves no smooth pose of the past", "odograph.h", "content never jumps relative to the image") {
  view before[MOMENTS], after[MOMENTS];
  corrected_walk(before, after);
  for (int i = 0; i < MOMENTS; ++i)
    CHECK(apart(before[i].smooth.p_n, after[i].smooth.p_n) < 1e-6, "smooth pose %d moved by %g m", i,
          apart(before[i].smooth.p_n, after[i].smooth.p_n));
}

CASE("after a correction an anchor is in the same place in the views of the past", "anchor.h",
     "Phone and anchor are consistent even if another thread corrects the track") {
  view before[MOMENTS], after[MOMENTS];
  corrected_walk(before, after);
  for (int i = 0; i < MOMENTS; ++i) {
    double in_n[3];
    CHECK(apart(before[i].anchor.p_n, after[i].anchor.p_n) > 2, "the anchor moved by only %g m",
          apart(before[i].anchor.p_n, after[i].anchor.p_n));
    CHECK(apart(before[i].anchor.p_view, after[i].anchor.p_view) < 0.05, "in view %d it moved by %g m", i,
          apart(before[i].anchor.p_view, after[i].anchor.p_view));
    rotate(after[i].corrected.q_n, after[i].anchor.p_view, in_n);
    in_n[0] += after[i].corrected.p_n[0], in_n[1] += after[i].corrected.p_n[1], in_n[2] += after[i].corrected.p_n[2];
    CHECK(apart(in_n, after[i].anchor.p_n) < 1e-6, "view %d and n are %g m apart", i, apart(in_n, after[i].anchor.p_n));
  }
}

/* `what`: 0: no extrinsics, 1: another world. */
static void pose_is_refused(int what) {
  hooks.on_message = walk_message;
  app* self = app_open(CONFIG WITH_ATTITUDE WITH_STEPS, ODO_RUN_REPLAY);
  push_rest_between(self, T0, T0 + SECOND);
  app_flush(self);
  odo_pose pose = {.header.struct_size = sizeof pose};
  EXPECT(odo.session_get_pose_of(self->session, ODO_OF_BODY, ODO_WORLD_SMOOTH, ODO_TIME_LATEST, &pose), ODO_OK);
  if (what == 0)
    EXPECT(odo.session_get_pose_of(self->session, ODO_OF_CAMERA, ODO_WORLD_SMOOTH, ODO_TIME_LATEST, &pose),
           ODO_NOT_READY);
  else
    EXPECT(odo.session_get_pose_of(self->session, ODO_OF_BODY, 2, ODO_TIME_LATEST, &pose), ODO_E_ARGUMENT);
}
CASE_OF(pose_is_refused, 0, "without extrinsics the body's pose is not converted to the camera's", "odograph.h",
        "ODO_NOT_READY if it is needed and they are unknown.");
CASE_OF(pose_is_refused, 1, "there are two worlds", "odograph.h", "ODO_E_ARGUMENT for any other `of` or world.");
