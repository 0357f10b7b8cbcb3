/* SPDX-License-Identifier: Apache-2.0
 *
 * Anchors: created, queried, listed, removed. */
#include "app.h"

#define MAKES "Ids count from 1, belong to the session and are never reused in it."

#define ORIGIN "navigation:\n  origin: {latitude: 0.83, longitude: 0.15, height: 400 m}\n"
#define START "  start: {position: [0 m, 0 m, 0 m], heading: 0}\n"

static odo_anchor_place place_of(uint32_t kind) {
  odo_anchor_place place = {.struct_size = sizeof place};
  place.kind = kind;
  place.t_ns = ODO_TIME_LATEST;
  if (kind == ODO_ANCHOR_GEODETIC) {
    place.height_above = ODO_HEIGHT_ELLIPSOID;
    place.latitude_rad = 0.83, place.longitude_rad = 0.15, place.height_m = 400;
  }
  return place;
}

static int32_t get(app* self, uint64_t id, odo_anchor* anchor) {
  memset(anchor, 0, sizeof *anchor);
  anchor->struct_size = sizeof *anchor;
  return odo.anchor_get(self->session, id, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, anchor);
}

static app* walk(const char* more, int seconds) {
  char config[512];
  hooks.on_message = walk_message;
  snprintf(config, sizeof config, "%s%s", CAMERA_WALK, more);
  app* self = app_open(config, ODO_RUN_REPLAY);
  for (int second = 0; second < seconds; ++second) walk_second(self, second);
  app_flush(self);
  return self;
}

CASE("anchors are numbered from 1, listed in their order and removed once", "anchor.h", MAKES) {
  app* self = walk("", 2);
  const odo_anchor_place place = place_of(ODO_ANCHOR_POSE);
  uint64_t ids[8], id = 0, next = 0;
  odo_anchor anchor;
  CHECK(odo.anchor_list(self->session, NULL, 0) == 0, "there are anchors before the first");
  EXPECT(odo.anchor_create(self->session, &place, &id), ODO_OK);
  EQUAL(id, 1);
  EXPECT(odo.anchor_create(self->session, &place, &next), ODO_OK);
  EQUAL(next, 2);
  EXPECT(odo.anchor_remove(self->session, next), ODO_OK);
  EXPECT(odo.anchor_remove(self->session, next), ODO_E_NOT_FOUND);
  EXPECT(get(self, next, &anchor), ODO_E_NOT_FOUND);
  EXPECT(odo.anchor_create(self->session, &place, &next), ODO_OK);
  EQUAL(next, 3);
  memset(ids, 0, sizeof ids);
  CHECK(odo.anchor_list(self->session, ids, 1) == 2 && ids[0] == 1 && ids[1] == 0,
        "with a capacity of 1 the list was %llu, %llu", (unsigned long long)ids[0], (unsigned long long)ids[1]);
  CHECK(odo.anchor_list(self->session, ids, 8) == 2 && ids[0] == 1 && ids[1] == 3,
        "the list was %llu, %llu; expected 1, 3", (unsigned long long)ids[0], (unsigned long long)ids[1]);
}

CASE("a local anchor needs a position", "anchor.h",
     "ODO_NOT_READY while the position of the phone is unknown (local anchors)") {
  app* self = walk("", 0);
  const odo_anchor_place pose = place_of(ODO_ANCHOR_POSE), view = place_of(ODO_ANCHOR_VIEW);
  uint64_t id = 77;
  EXPECT(odo.anchor_create(self->session, &pose, &id), ODO_NOT_READY);
  EXPECT(odo.anchor_create(self->session, &view, &id), ODO_NOT_READY);
  CHECK(odo.anchor_list(self->session, NULL, 0) == 0, "there is an anchor");
}

CASE("a local anchor needs a time that is kept", "anchor.h", "ODO_E_NOT_FOUND for a time outside the stored poses") {
  app* self = walk("", 2);
  odo_anchor_place place = place_of(ODO_ANCHOR_POSE);
  uint64_t id;
  place.t_ns = T0 - 100 * SECOND;
  EXPECT(odo.anchor_create(self->session, &place, &id), ODO_E_NOT_FOUND);
  place.t_ns = T0 + SECOND;
  EXPECT(odo.anchor_create(self->session, &place, &id), ODO_OK);
}

CASE("bad places are refused", "anchor.h",
     "ODO_E_ARGUMENT (unknown kind, number not finite or beyond 1e9, q not a unit quaternion, latitude beyond a pole, "
     "longitude beyond 2 pi, name of more than 63 bytes)") {
  app* self = walk(ORIGIN, 2);
  uint64_t id;
  for (int which = 0; which < 11; ++which) {
    odo_anchor_place place = place_of(which < 4 || which > 9 ? ODO_ANCHOR_POSE : ODO_ANCHOR_GEODETIC);
    int32_t status;
    if (which == 0) place.kind = 0;
    if (which == 1) place.kind = 99;
    if (which == 2) place.p[1] = (double)NAN;
    if (which == 3) place.q[0] = 3;
    if (which == 4) place.latitude_rad = 1.6;
    if (which == 5) place.longitude_rad = (double)INFINITY;
    if (which == 6) place.height_above = 9;
    if (which == 7) place.sigma_m = (double)NAN;
    if (which == 8) place.longitude_rad = 6.29;
    if (which == 9) place.longitude_rad = -8.5; /* degrees */
    if (which == 10) place.name = string_of("a name of sixty-four bytes, one more than an anchor's name may h");
    status = odo.anchor_create(self->session, &place, &id);
    CHECK(status == ODO_E_ARGUMENT, "place %d: odo_anchor_create = %s; expected ODO_E_ARGUMENT", which,
          status_name(status));
  }
  CHECK(odo.anchor_list(self->session, NULL, 0) == 0, "there is an anchor");
}

CASE("there are 1024 anchors at most", "anchor.h", "ODO_E_EXHAUSTED beyond 1024 anchors") {
  app* self = walk("", 1);
  const odo_anchor_place place = place_of(ODO_ANCHOR_GEODETIC);
  uint64_t id;
  for (int i = 0; i < 1024; ++i) EXPECT(odo.anchor_create(self->session, &place, &id), ODO_OK);
  EXPECT(odo.anchor_create(self->session, &place, &id), ODO_E_EXHAUSTED);
  EXPECT(odo.anchor_remove(self->session, 5), ODO_OK);
  EXPECT(odo.anchor_create(self->session, &place, &id), ODO_OK);
  EQUAL(id, 1025);
}

CASE("a local anchor is where it was put, with 63 bytes of its name", "anchor.h", "UTF-8, at most 63 bytes") {
  app* self = walk("", 2);
  odo_anchor_place place = place_of(ODO_ANCHOR_POSE);
  odo_anchor anchor;
  uint64_t id;
  place.p[0] = 5, place.p[2] = -1;
  place.name = string_of("a name of sixty-three bytes, as many as an anchor's name may be");
  EXPECT(odo.anchor_create(self->session, &place, &id), ODO_OK);
  EXPECT(get(self, id, &anchor), ODO_OK);
  CHECK(anchor.id == id && anchor.kind == ODO_ANCHOR_POSE, "it has id %llu and kind %u", (unsigned long long)anchor.id,
        anchor.kind);
  CHECK((anchor.flags & ODO_ANCHOR_PLACED) && (anchor.flags & ODO_ANCHOR_VIEW_POSE) &&
            !(anchor.flags & ODO_ANCHOR_ON_EARTH),
        "its flags are 0x%x", anchor.flags);
  CHECK(fabs(anchor.p_n[0] - 5) < 1e-6 && fabs(anchor.p_n[2] + 1) < 1e-6, "it is at %g, %g, %g", anchor.p_n[0],
        anchor.p_n[1], anchor.p_n[2]);
  CHECK(fabs(anchor.p_view[0] - 3.1) < 0.2, "in the view it is %g m ahead; expected about 3.1", anchor.p_view[0]);
  CHECK(anchor.q_n[0] == 1, "all zero is no rotation: q_n begins with %g", anchor.q_n[0]);
  CHECK(strcmp(anchor.name, "a name of sixty-three bytes, as many as an anchor's name may be") == 0,
        "its name is \"%.64s\"", anchor.name);
}

/* A geodetic anchor created before the last second of a walk. */
static odo_anchor geodetic(const char* navigation, uint32_t height_above) {
  app* self = walk(navigation, 2);
  odo_anchor_place place = place_of(ODO_ANCHOR_GEODETIC);
  odo_anchor anchor;
  uint64_t id;
  place.height_above = height_above;
  EXPECT(odo.anchor_create(self->session, &place, &id), ODO_OK);
  walk_second(self, 2); /* a pose determines its position */
  app_flush(self);
  EXPECT(get(self, id, &anchor), ODO_OK);
  return anchor;
}

CASE("a geodetic anchor is placed where start and origin are known", "anchor.h",
     "A geodetic anchor is placed as soon as the position of the phone in n, the origin of n and, above terrain, the "
     "height of the ground are known.") {
  const odo_anchor anchor = geodetic(ORIGIN START, ODO_HEIGHT_ELLIPSOID);
  CHECK(anchor.flags & ODO_ANCHOR_PLACED, "its flags are 0x%x and its reason %u", anchor.flags, anchor.reason);
  CHECK(fabs(anchor.p_n[0]) < 1e-3 && fabs(anchor.p_n[2]) < 1e-3, "at the origin it is at %g, %g, %g", anchor.p_n[0],
        anchor.p_n[1], anchor.p_n[2]);
}

/* `reason`: the expected reason why it is not placed. */
static void not_placed(int reason) {
  const char* navigation = reason == ODO_REASON_NO_ORIGIN   ? "navigation:\n" START
                           : reason == ODO_REASON_NO_GROUND ? ORIGIN START
                                                            : ORIGIN;
  const odo_anchor anchor =
      geodetic(navigation, reason == ODO_REASON_NO_GROUND ? ODO_HEIGHT_TERRAIN : ODO_HEIGHT_ELLIPSOID);
  CHECK(!(anchor.flags & (ODO_ANCHOR_PLACED | ODO_ANCHOR_VIEW_POSE | ODO_ANCHOR_IN_FRONT)) && anchor.state == ODO_LOST,
        "its flags are 0x%x and its state is %u", anchor.flags, anchor.state);
  CHECK(anchor.reason == (uint32_t)reason, "its reason is %u; expected %d", anchor.reason, reason);
}
CASE_OF(not_placed, ODO_REASON_NO_FIX, "a geodetic anchor without start and fix is lost for want of a fix", "anchor.h",
        "position of the phone in n unknown: neither navigation.start nor a position fix");
CASE_OF(not_placed, ODO_REASON_NO_ORIGIN, "a geodetic anchor without an origin is lost for want of the origin",
        "anchor.h", "position in n known, origin of n unknown: neither navigation.origin nor GNSS");
CASE_OF(not_placed, ODO_REASON_NO_GROUND,
        "an anchor above terrain without a terrain model is lost for want of the ground", "anchor.h",
        "height of the ground unknown at that point");

CASE("an anchor behind the camera has a pose in the view and is not in front", "anchor.h",
     "With VIEW_POSE: the anchor is on the side that the camera faces") {
  app* self = walk("", 2);
  odo_anchor_place place = place_of(ODO_ANCHOR_VIEW);
  odo_anchor anchor;
  uint64_t ahead, behind;
  place.p[2] = 3;
  EXPECT(odo.anchor_create(self->session, &place, &ahead), ODO_OK);
  place.p[2] = -3;
  EXPECT(odo.anchor_create(self->session, &place, &behind), ODO_OK);
  EXPECT(get(self, ahead, &anchor), ODO_OK);
  CHECK((anchor.flags & ODO_ANCHOR_VIEW_POSE) && (anchor.flags & ODO_ANCHOR_IN_FRONT) && anchor.p_view[2] > 2,
        "ahead of the camera it has flags 0x%x and p_view[2] = %g", anchor.flags, anchor.p_view[2]);
  EXPECT(get(self, behind, &anchor), ODO_OK);
  CHECK((anchor.flags & ODO_ANCHOR_VIEW_POSE) && !(anchor.flags & ODO_ANCHOR_IN_FRONT) && anchor.p_view[2] < -2,
        "behind the camera it has flags 0x%x and p_view[2] = %g", anchor.flags, anchor.p_view[2]);
}
