/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 5: anchors. An anchor is a place in the world that something is drawn at. Its numbers in n change
 * when the track is corrected, so that what is drawn there stays where it belongs.
 *
 * A local anchor (ODO_ANCHOR_POSE, ODO_ANCHOR_VIEW) hangs on the phone's pose at the time at which it was seen, and goes
 * with what is learnt later of that pose: a fix at the end of a walk moves what was placed at its start by what the start
 * was wrong by, not by what the end was. A geospatial anchor (ODO_ANCHOR_GEODETIC) stays where it is on the Earth.
 *
 * What ARCore and ARKit call: anchor = odo_anchor_create, detach or remove = odo_anchor_remove, getPose or transform =
 * odo_anchor_get, geospatial anchor and ARGeoAnchor = ODO_ANCHOR_GEODETIC, terrain anchor = ODO_HEIGHT_TERRAIN.
 */
#ifndef ODOGRAPH_ANCHOR_H
#define ODOGRAPH_ANCHOR_H

#include <odograph/odograph.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ODO_ANCHOR_POSE 1u     /* q and p are in n */
#define ODO_ANCHOR_VIEW 2u     /* q and p are in the axes of the pose of t_ns: what a touch on a picture finds */
#define ODO_ANCHOR_GEODETIC 3u /* a latitude, longitude and height */

#define ODO_HEIGHT_ELLIPSOID 1u /* above the WGS 84 ellipsoid */
#define ODO_HEIGHT_GEOID 2u     /* above the geoid ("sea level"), which is geoid_height_m above the ellipsoid there */
#define ODO_HEIGHT_TERRAIN 3u   /* above the ground, as a fixer with a terrain model has it */

/* Two worlds an app may draw in, each with its own pose of the phone. */
#define ODO_WORLD_CORRECTED 0u /* odo_session_get_pose: what is known best; jumps */
#define ODO_WORLD_SMOOTH 1u    /* odo_session_get_smooth_pose: what is drawn never jumps against the picture */

/* Where an anchor is to be. Zero what is not used. */
typedef struct odo_anchor_place {
  uint32_t struct_size;
  uint32_t kind;         /* ODO_ANCHOR_* */
  int64_t t_ns;          /* POSE, VIEW: when it was seen, at best within the last 3 s; ODO_TIME_LATEST: now */
  uint32_t world;        /* POSE: the world that q and p are of, ODO_WORLD_* */
  uint32_t height_above; /* GEODETIC: ODO_HEIGHT_* */
  double q[4];           /* the anchor's axes to those of n (POSE, GEODETIC: North-East-Down there) or of the pose (VIEW);
                          * all zero: no rotation */
  double p[3];           /* POSE, VIEW: m */
  double latitude_rad;   /* GEODETIC: WGS 84 */
  double longitude_rad;
  double height_m;
  double geoid_height_m; /* with ODO_HEIGHT_GEOID */
  double sigma_m;        /* GEODETIC: standard deviation of the place itself, in each axis */
  odo_string name;       /* UTF-8; the first 63 bytes are kept */
} odo_anchor_place;

#define ODO_ANCHOR_PLACED 1u    /* q_n, p_n and their sigmas are valid */
#define ODO_ANCHOR_VIEW_POSE 2u /* q_view, p_view and view_sigma_m are valid, also behind the camera */
#define ODO_ANCHOR_ON_EARTH 4u  /* latitude, longitude and height are valid */
/* With VIEW_POSE: it is on the side that the phone's camera faces. p_view[2] > 0 where the pose is the camera's, p_view[2] < 0
 * where it is the body's, whose z axis points out of the screen. */
#define ODO_ANCHOR_IN_FRONT 8u

/* Why an anchor is not placed yet; they continue ODO_REASON_*. */
#define ODO_REASON_NO_FIX 10u    /* the phone's place in n is not known: neither navigation.start nor a position fix */
#define ODO_REASON_NO_GROUND 11u /* the height of the ground there is not known */
#define ODO_REASON_NO_ORIGIN 12u /* the phone's place in n is known, n's on the Earth is not: no navigation.origin, no GNSS */

/* An anchor as it is at a time. */
typedef struct odo_anchor {
  uint32_t struct_size;
  uint32_t kind;         /* ODO_ANCHOR_* */
  uint64_t id;
  int64_t t_ns;          /* asked for */
  uint32_t flags;        /* ODO_ANCHOR_PLACED ... */
  uint32_t state;        /* ODO_TRACKING: draw it; ODO_DEGRADED: it may be off; ODO_LOST: not placed, or the phone is not */
  uint32_t reason;       /* ODO_REASON_*: of the phone's state, or why it is not placed */
  uint32_t reserved;     /* 0 */
  double q_n[4];         /* in the world asked for */
  double p_n[3];         /* m */
  double q_view[4];      /* in the axes of the phone's pose at t_ns in that world, m: what a renderer needs. Phone and anchor */
  double p_view[3];      /* are of one moment here, also while another thread corrects the track */
  double position_sigma_m; /* standard deviation of p_n, in its worst direction */
  double yaw_sigma_rad;    /* of its rotation about the vertical */
  double view_sigma_m;     /* of p_view, in its worst direction: how far off it may be seen */
  double latitude_rad;
  double longitude_rad;
  double height_m;       /* above the ellipsoid */
  char name[64];         /* terminated */
} odo_anchor;

/* [any] Makes an anchor; its id counts from 1 and is never used again. A geodetic one is made at once and gets its place as
 * soon as the phone's place in n, n's place on the Earth and, above terrain, the ground there are known. Anchors that
 * odo_session_load brought back are there already: look for yours by its name among odo_anchor_list before you make it. ODO_NOT_READY while the phone's position
 * is not known (a local one), ODO_E_NOT_FOUND for a time outside of what is kept, ODO_E_EXHAUSTED beyond 1024 anchors,
 * ODO_E_ARGUMENT (unknown kind, a number that is not finite, no unit quaternion, a latitude beyond a pole). */
ODO_API int32_t ODO_CALL odo_anchor_create(odo_session *session, const odo_anchor_place *place, uint64_t *id);

/* [any] The anchor at a time (ODO_TIME_LATEST: at the newest sample), in a world: ODO_WORLD_*. Asks for the pose as
 * odo_session_get_pose does, of the camera where there is one. Takes microseconds and never waits for the pipeline.
 * ODO_E_NOT_FOUND: no such anchor. */
ODO_API int32_t ODO_CALL odo_anchor_get(odo_session *session, uint64_t id, uint32_t world, int64_t t_ns,
                                        odo_anchor *anchor);

/* [any] How many anchors there are; writes as many of their ids as `capacity` allows, in the order of their making. ids may
 * be null with capacity 0. */
ODO_API int64_t ODO_CALL odo_anchor_list(odo_session *session, uint64_t *ids, uint64_t capacity);

/* [any] Ends it. ODO_E_NOT_FOUND: no such anchor. */
ODO_API int32_t ODO_CALL odo_anchor_remove(odo_session *session, uint64_t id);

#ifdef __cplusplus
}
#endif
#endif
