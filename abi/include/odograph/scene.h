/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 6: what is around the phone, since 1.1. Landmarks of the front-end, plane patches of surface
 * finders (surface_finder: in the config), and rays that hit them: where a user who touches the picture means.
 *
 * Equivalents in ARCore and ARKit: Frame.hitTest, raycast = odo_session_hit_test; Plane, ARPlaneAnchor = odo_surface;
 * acquirePointCloud, rawFeaturePoints = odo_session_get_points; hitResult.createAnchor = ODO_ANCHOR_HIT.
 *
 * All functions take microseconds, never wait for the pipeline, and give positions in the worlds of anchors
 * (ODO_WORLD_*). An array of structs is described by its first element, in which the caller sets struct_size: the size of
 * each element in, the bytes written to each out.
 */
#ifndef ODOGRAPH_SCENE_H
#define ODOGRAPH_SCENE_H

#include <odograph/odograph.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A landmark that the host keeps. */
typedef struct odo_map_point {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  int64_t t_ns;      /* time of the frame in which it was last seen */
  double p_n[3];     /* m */
  double sigma_m;    /* standard deviation in its worst direction, relative to the phone when it was seen */
} odo_map_point;

#define ODO_MOST_MAP_POINTS 4096u /* what the host keeps: one in a cube of 10 cm, the newest ones */

/* [any] Returns the number of landmarks and writes at most `capacity` of them. points may be null with capacity 0. None
 * while the scale is unknown. A negative value is a status: ODO_E_ARGUMENT, ODO_E_STRUCT_SIZE. */
ODO_API int64_t ODO_CALL odo_session_get_points(odo_session *session, uint32_t world, odo_map_point *points,
                                                uint64_t capacity);

/* [any] Returns the number of surfaces and writes at most `capacity` of their ids, the oldest first. ids may be null
 * with capacity 0. */
ODO_API int64_t ODO_CALL odo_surface_list(odo_session *session, uint64_t *ids, uint64_t capacity);

/* [any] Writes a surface with its outline (ODO_VERTEX_AT); surface->header.struct_size: capacity in, bytes written out.
 * ODO_LARGEST_SURFACE bytes suffice. ODO_E_NOT_FOUND: no such surface, ODO_E_STRUCT_SIZE: no room for the outline. */
ODO_API int32_t ODO_CALL odo_surface_get(odo_session *session, uint64_t id, uint32_t world, odo_surface *surface);

#define ODO_RAY_PIXEL 1u /* through a pixel of a camera, at the time of its frame */
#define ODO_RAY_VIEW 2u  /* origin and direction are in the axes of the pose at t_ns (odo_session_get_pose) */
#define ODO_RAY_WORLD 3u /* origin and direction are in n */
/* What a ray may hit. */
#define ODO_HIT_SURFACE 1u
#define ODO_HIT_POINT 2u
/* The floor beyond what was seen of it. Before one is found, it is assumed below a walker's hand, at 0.8 of
 * walker.height; odo_hit.surface is then 0. */
#define ODO_HIT_FLOOR 4u

/* The ray. Set unused members to zero. */
typedef struct odo_ray {
  uint32_t struct_size;
  uint32_t kind;         /* ODO_RAY_* */
  int64_t t_ns;          /* time of the view, that of a pose; ODO_TIME_LATEST: now */
  uint32_t world;        /* of WORLD, and of all hits: ODO_WORLD_* */
  uint32_t camera;       /* PIXEL: header.source of its frames, which must be the pipeline's camera */
  double pixel[2];       /* PIXEL: column and row in the pushed frame (not on the screen), 0, 0: middle of the first */
  double origin[3];      /* VIEW, WORLD: m */
  double direction[3];   /* VIEW, WORLD: of any length above 0 */
  double max_distance_m; /* 0: any */
  uint32_t wanted;       /* ODO_HIT_*, any of them; 0: all */
  uint32_t reserved;     /* 0 */
} odo_ray;

typedef struct odo_hit {
  uint32_t struct_size;
  uint32_t what;         /* ODO_HIT_* */
  uint64_t surface;      /* id of the surface, 0: none */
  int64_t t_ns;          /* time of the view */
  uint32_t surface_kind; /* ODO_SURFACE_*, 0: none */
  uint32_t reserved;     /* 0 */
  double q_n[4];         /* rotates vectors from the hit to n: z is the normal, x points away from the origin of the ray
                          * along the surface. At a point, the normal points back along the ray */
  double p_n[3];         /* position in n, m */
  double normal_n[3];    /* of length 1 */
  double distance_m;     /* from the origin of the ray */
  double sigma_m;        /* standard deviation of the distance, with that of the scale */
  double scale_sigma;    /* relative standard deviation of the scale, which all lengths have in common: its share of
                          * sigma_m is scale_sigma * distance_m, and of a length between two hits scale_sigma * length */
} odo_hit;

/* [any] Intersects a ray with surfaces, landmarks and the floor: writes the nearest `capacity` hits, at most 64, nearest
 * first, and their number. A landmark is hit within half a degree, unless it is part of a surface that is. Surfaces are
 * hit on both sides. ODO_NOT_READY while the position or the metric scale is unknown (count 0), ODO_E_NOT_FOUND for a
 * time outside the stored poses (or PIXEL without a calibration of that camera), ODO_E_ARGUMENT (unknown kind or world,
 * a number that is not finite, another camera than the pipeline's, a pixel outside the picture), ODO_E_STRUCT_SIZE. */
ODO_API int32_t ODO_CALL odo_session_hit_test(odo_session *session, const odo_ray *ray, odo_hit *hits,
                                              uint32_t capacity, uint32_t *count);

#ifdef __cplusplus
}
#endif
#endif
