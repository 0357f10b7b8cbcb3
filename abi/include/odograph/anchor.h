/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 5: anchors. An anchor is a pose that stays fixed to the real world, for content drawn there. Its
 * coordinates in n change when the track is corrected.
 *
 * A local anchor (ODO_ANCHOR_POSE, ODO_ANCHOR_VIEW) is attached to the pose of the phone at its time of observation,
 * and moves with later corrections of that pose: a fix at the end of a walk moves an anchor placed at the start by the
 * error of the start, not by that of the end. A geospatial anchor (ODO_ANCHOR_GEODETIC) stays fixed to the Earth.
 *
 * Equivalents in ARCore and ARKit: createAnchor, add = odo_anchor_create; detach, remove = odo_anchor_remove; getPose,
 * transform = odo_anchor_get; geospatial anchor, ARGeoAnchor = ODO_ANCHOR_GEODETIC; terrain anchor =
 * ODO_HEIGHT_TERRAIN.
 */
#ifndef ODOGRAPH_ANCHOR_H
#define ODOGRAPH_ANCHOR_H

#include <odograph/odograph.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ODO_ANCHOR_POSE 1u     /* q and p are in n */
#define ODO_ANCHOR_VIEW 2u     /* q and p are in the axes of the pose at t_ns, e.g. a point touched in the image */
#define ODO_ANCHOR_GEODETIC 3u /* a latitude, longitude and height */
/* Since 1.1: like POSE, at the pose of an odo_hit. While the surface that was hit exists, the anchor is fixed to it (to
 * the remaining one after a merger). Without a surface, or once it is withdrawn, it is an ordinary local anchor. */
#define ODO_ANCHOR_HIT 4u

#define ODO_HEIGHT_ELLIPSOID 1u /* above the WGS 84 ellipsoid */
#define ODO_HEIGHT_GEOID 2u     /* above the geoid ("sea level"), which is geoid_height_m above the ellipsoid there */
#define ODO_HEIGHT_TERRAIN 3u   /* above the ground, from a plugin with a terrain model */

/* Placement of a new anchor. Set unused members to zero. */
typedef struct odo_anchor_place {
  uint32_t struct_size;
  uint32_t kind;         /* ODO_ANCHOR_* */
  int64_t t_ns;          /* POSE, VIEW, HIT: time of observation, preferably within the last 3 s; ODO_TIME_LATEST: now */
  uint32_t world;        /* POSE, HIT: world of q and p, ODO_WORLD_* */
  uint32_t height_above; /* GEODETIC: ODO_HEIGHT_* */
  double q[4];           /* rotates vectors from the anchor to n (POSE, HIT), to North-East-Down at the anchor (GEODETIC)
                          * or to the axes of the pose (VIEW); all zero: no rotation */
  double p[3];           /* POSE, VIEW, HIT: m */
  double latitude_rad;   /* GEODETIC: WGS 84 */
  double longitude_rad;
  double height_m;
  double geoid_height_m; /* with ODO_HEIGHT_GEOID */
  double sigma_m;        /* GEODETIC, HIT (that of the hit): standard deviation of the given position, in each axis */
  odo_string name;       /* UTF-8, at most 63 bytes */
  uint64_t surface;      /* HIT, which needs it: id of the surface that was hit, 0: another hit. One that was withdrawn
                          * or merged since the hit test counts as 0. Since 1.1 */
} odo_anchor_place;

#define ODO_ANCHOR_PLACED 1u    /* q_n, p_n and their sigmas are valid */
#define ODO_ANCHOR_VIEW_POSE 2u /* q_view, p_view and view_sigma_m are valid, also behind the camera */
#define ODO_ANCHOR_ON_EARTH 4u  /* latitude, longitude and height are valid */
/* With VIEW_POSE: the anchor is on the side that the camera faces: p_view[2] > 0 for a pose of the camera, p_view[2] <
 * 0 for a pose of the body, whose z axis points out of the screen. */
#define ODO_ANCHOR_IN_FRONT 8u

/* Reasons why an anchor is not placed yet, in addition to ODO_REASON_* of events.h. */
#define ODO_REASON_NO_FIX 10u    /* position of the phone in n unknown: neither navigation.start nor a position fix */
#define ODO_REASON_NO_GROUND 11u /* height of the ground unknown at that point */
#define ODO_REASON_NO_ORIGIN 12u /* position in n known, origin of n unknown: neither navigation.origin nor GNSS */

/* State of an anchor at a time. */
typedef struct odo_anchor {
  uint32_t struct_size;
  uint32_t kind;         /* ODO_ANCHOR_* */
  uint64_t id;
  int64_t t_ns;          /* requested time, with ODO_TIME_LATEST that of the newest sample, or INT64_MIN before it */
  uint32_t flags;        /* ODO_ANCHOR_PLACED ... */
  uint32_t state;        /* ODO_TRACKING: draw it; ODO_DEGRADED: less accurate; ODO_LOST: anchor or phone not placed */
  uint32_t reason;       /* ODO_REASON_*: of the state of the phone, or why the anchor is not placed */
  uint32_t reserved;     /* 0 */
  double q_n[4];         /* rotates vectors from the anchor to n, in the requested world */
  double p_n[3];         /* position in n, m */
  double q_view[4];      /* for rendering: rotates vectors from the anchor to the axes of the phone's pose at t_ns */
  double p_view[3];      /* position in these axes, m. Phone and anchor are consistent even if another thread corrects
                          * the track */
  double position_sigma_m; /* standard deviation of p_n in its worst direction */
  double yaw_sigma_rad;    /* standard deviation of the rotation about the vertical */
  double view_sigma_m;     /* standard deviation of p_view in its worst direction: the visible error. Of a new
                            * local anchor it lacks the motion since t_ns until the next odo_pose: 0 is not known yet */
  double latitude_rad;
  double longitude_rad;
  double height_m;       /* above the ellipsoid */
  char name[64];         /* terminated */
} odo_anchor;

/* [any] Creates an anchor. Ids count from 1, belong to the session and are never reused in it. A geodetic anchor is
 * placed as soon as the position of the phone in n, the origin of n and, above terrain, the height of the ground are
 * known. odo_session_load restores saved anchors: look for the name in odo_anchor_list before creating an anchor again.
 * A local anchor is saved if the position of the phone in n is known: on the Earth if n has an origin, otherwise in n.
 * Returns ODO_NOT_READY while the position of the phone is unknown (local anchors), ODO_E_NOT_FOUND for a time outside
 * the stored poses or a surface that the session never had, ODO_E_EXHAUSTED beyond 1024 anchors, ODO_E_ARGUMENT
 * (unknown kind, number not finite or beyond 1e9, q not a unit quaternion, latitude beyond a pole, longitude beyond 2 pi,
 * name of more than 63 bytes). */
ODO_API int32_t ODO_CALL odo_anchor_create(odo_session *session, const odo_anchor_place *place, uint64_t *id);

/* [any] Returns the anchor at a time (ODO_TIME_LATEST: at the newest sample) in a world (ODO_WORLD_*), relative to the
 * pose of odo_session_get_pose at that time. Takes microseconds and never waits for the pipeline. ODO_E_NOT_FOUND: no
 * such anchor. */
ODO_API int32_t ODO_CALL odo_anchor_get(odo_session *session, uint64_t id, uint32_t world, int64_t t_ns,
                                        odo_anchor *anchor);

/* [any] Returns the number of anchors and writes at most `capacity` of their ids, in order of creation. ids may be null
 * with capacity 0. */
ODO_API int64_t ODO_CALL odo_anchor_list(odo_session *session, uint64_t *ids, uint64_t capacity);

/* [any] Removes an anchor. ODO_E_NOT_FOUND: no such anchor. */
ODO_API int32_t ODO_CALL odo_anchor_remove(odo_session *session, uint64_t id);

#ifdef __cplusplus
}
#endif
#endif
