/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: events, the output of plugins and of the host. base.h has the conventions and rules.
 */
#ifndef ODOGRAPH_EVENTS_H
#define ODOGRAPH_EVENTS_H

#include <odograph/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Orientation of the body. The heading is relative to magnetic north with MAGNETIC_NORTH, to true north with
 * TRUE_NORTH, and to an arbitrary direction otherwise. If the declination is known, the host rotates magnetic attitudes
 * to true north before it publishes and distributes them, and sets TRUE_NORTH instead. */
#define ODO_ATTITUDE_MAGNETIC_NORTH 1u
#define ODO_ATTITUDE_MAG_DISTURBED 2u /* the measured magnetic field is not the Earth's */
#define ODO_ATTITUDE_REST 4u          /* the device is at rest */
#define ODO_ATTITUDE_TRUE_NORTH 8u
#define ODO_ATTITUDE_COVARIANCE 16u
#define ODO_ATTITUDE_GYRO_BIAS 32u
typedef struct odo_attitude {
  odo_header header;
  double q_n_b[4];        /* always valid */
  double covariance_n[9]; /* of the rotation, in n, rad^2 */
  double gyro_bias_b[3];  /* rad/s; subtract it from the measurement */
} odo_attitude;

#define ODO_MODE_UNKNOWN 0u
#define ODO_MODE_STATIC 1u
#define ODO_MODE_WALKING_TEXTING 2u
#define ODO_MODE_WALKING_SWINGING 3u
#define ODO_MODE_WALKING_POCKET 4u
#define ODO_MODE_STAIRS 5u
#define ODO_MODE_RUNNING 6u
#define ODO_MODE_HANDLING 7u /* the hand moves the phone, the user does not walk */

/* One step, from the contact of one foot to the contact of the other (a stride is two steps). Without ODO_STEP_HEADING
 * it has a length only. Then `coupling: {type: localizer}` takes the direction from the heading of the phone; the
 * default coupling takes displacements from the camera only, and without a camera the position does not change (report
 * `no_heading`). */
#define ODO_STEP_HEADING 1u
#define ODO_STEP_HEADING_SIGMA 2u
typedef struct odo_step {
  odo_header header;   /* t_ns: newest sample used for the detection */
  int64_t t_start_ns;
  int64_t t_end_ns;    /* foot contact */
  double length_m;     /* horizontal */
  double sigma_m;      /* standard deviation of length_m; always valid */
  double frequency_hz; /* step frequency */
  double heading_rad;  /* walking direction in n, from north to east */
  uint32_t mode;       /* ODO_MODE_* */
  uint32_t index;      /* counts from 0 since activation */
  double heading_sigma_rad; /* standard deviation of heading_rad */
} odo_step;

typedef struct odo_motion_mode {
  odo_header header; /* t_ns: start of the mode */
  uint32_t mode;
  uint32_t reserved; /* 0 */
} odo_motion_mode;

#define ODO_TRACKING 1u
#define ODO_DEGRADED 2u
#define ODO_LOST 3u
#define ODO_REASON_NONE 0u
#define ODO_REASON_INITIALISING 1u
#define ODO_REASON_TOO_DARK 2u
#define ODO_REASON_TOO_FAST 3u
#define ODO_REASON_FEW_FEATURES 4u
#define ODO_REASON_NO_PARALLAX 5u
#define ODO_REASON_NO_STEPS 6u
#define ODO_REASON_SENSOR_SILENT 7u
#define ODO_REASON_PLUGIN_FAILED 8u
#define ODO_REASON_NO_SCALE 9u
/* 10 to 12: anchor.h */
#define ODO_REASON_WRONG_INPUT 13u /* since 1.1: a unit, sign, axis, mount or clock is wrong; a report has the words */

/* Camera motion between two frames, up to scale. */
#define ODO_VO_ROTATION 1u    /* q_c0_c1 is valid */
#define ODO_VO_TRANSLATION 2u /* p_c0_c1 is valid */
#define ODO_VO_COVARIANCE 4u
#define ODO_VO_METRIC 8u       /* displacements are in metres, with relative error scale_sigma, which is valid */
#define ODO_VO_INERTIAL 16u    /* scale_sigma, velocity_c1, gravity_c1 and the biases are valid */
typedef struct odo_vo_motion {
  odo_header header;     /* t_ns: time of the later frame, c1 */
  int64_t t_from_ns;     /* time of the earlier frame, c0: t_ns of the previous result, even if it was lost */
  double q_c0_c1[4];
  double p_c0_c1[3];     /* position of c1 in c0, up to scale */
  double covariance[36]; /* of (rotation in c0, position in c0), rad^2 and displacement units^2 */
  double q_n_c0[4];      /* orientation of c0, estimated by the host; valid with ODO_FLAG_NAVIGATION */
  uint32_t camera;       /* header.source of its frames */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t reason;       /* ODO_REASON_* */
  uint32_t scale_group;  /* motions of one group have one scale; a new number after the scale may have changed. A group
                          * belongs to its instance (header.source) since its last reset */
  uint32_t tracked;      /* number of features tracked from c0 to c1 */
  uint32_t inliers;      /* number of these that agree with the motion */
  double scale_sigma;    /* relative standard deviation of the scale; successive motions of a group share the error */
  double velocity_c1[3]; /* of the camera at the later frame, in c1, displacement units per second */
  double gravity_c1[3];  /* direction of gravity in c1, downwards, unit length */
  double gyro_bias_b[3]; /* rad/s; subtract it from the measurement */
  double accel_bias_b[3]; /* m/s^2; subtract it from the measurement */
} odo_vo_motion;

/* Scale of the displacements of a front-end. On published scales, ODO_FLAG_ACCEPTED means that it was in time and
 * belongs to the current scale group. */
#define ODO_SCALE_HORIZONTAL 1u   /* applies only to the horizontal part of the displacement */
#define ODO_SCALE_STEADY 2u       /* also holds for earlier motions of its group */
#define ODO_SCALE_NOT_BY_STEPS 4u /* independent of step lengths, so that its displacement may calibrate them */
typedef struct odo_scale {
  odo_header header;
  int64_t valid_from_ns;  /* applies to motions that end after valid_from_ns ... */
  int64_t valid_to_ns;    /* ... and not after valid_to_ns */
  double scale;           /* metres = scale * displacement */
  double sigma;           /* standard deviation of scale; always valid */
  double displacement_m;  /* metric displacement from which the scale was computed; 0 if there is none */
  uint32_t scale_group;
  uint32_t reserved;      /* 0 */
} odo_scale;

/* Absolute position or orientation. Each component of p_n has its bit. A position requires ODO_FIX_COVARIANCE and an
 * orientation ODO_FIX_ORIENTATION_COVARIANCE; otherwise the host rejects it (ODO_E_ARGUMENT). On published fixes,
 * ODO_FLAG_ACCEPTED means that the host used the fix. */
#define ODO_FIX_NORTH 1u
#define ODO_FIX_EAST 2u
#define ODO_FIX_DOWN 4u
#define ODO_FIX_YAW 8u           /* yaw_rad, yaw_sigma_rad and yaw_axis_b are valid */
#define ODO_FIX_ORIENTATION 16u
/* The position is given by latitude and longitude instead of p_n; the host converts it. North and east are then valid
 * without their bits, and height_m is valid with ODO_FIX_DOWN. */
#define ODO_FIX_GEODETIC 32u
#define ODO_FIX_SLANT 64u        /* landmark_n and slant_distance_m are valid */
#define ODO_FIX_COVARIANCE 128u
#define ODO_FIX_ORIENTATION_COVARIANCE 256u
#define ODO_FIX_INTEGRITY 512u
#define ODO_FIX_LEVER 1024u      /* if not set, p_n is the position of the origin of b */
#define ODO_FIX_CROSS_COVARIANCE 2048u
#define ODO_FIX_SLANT_SIGMA 4096u
typedef struct odo_fix {
  odo_header header;
  double p_n[3];                 /* position in n of the point lever_b, m */
  double covariance_n[9];        /* of p_n, m^2; with GEODETIC in North-East-Down at the position */
  double q_n_b[4];
  double orientation_cov_n[9];   /* of the rotation, in n, rad^2 */
  double yaw_rad;                /* heading of the horizontal part of yaw_axis_b, from north to east */
  double yaw_sigma_rad;          /* standard deviation of yaw_rad */
  double latitude_rad;           /* of the point lever_b */
  double longitude_rad;
  double height_m;               /* ellipsoidal */
  double integrity;              /* probability that the error is larger than the covariance can explain */
  double landmark_n[3];          /* surveyed point in view of the camera, such as the edge of a roof, m */
  double slant_distance_m;       /* distance from the camera to landmark_n */
  double lever_b[3];             /* point in b whose position is given (a camera, an antenna), m */
  double yaw_axis_b[3];          /* unit vector in b: (0, 1, 0) is the top of a phone, (0, 0, -1) its back. Use the back
                                  * for a phone held upright, whose top has no horizontal direction */
  double cross_covariance_n[9];  /* of rotation (rows) and position (columns), rad m; not used by this library up to 1.0 */
  double slant_sigma_m;          /* standard deviation of slant_distance_m */
} odo_fix;

/* Relative pose of the body between two times, for example from a loop closure. The host publishes and records it and
 * passes it to plugins that declare it, and may use it; not used by this library up to 1.0. Since 1.1 it corrects
 * position and heading if the earlier time is that of an odo_key_frame of the same source or at most 3 s before the
 * newest pose; both components are required, and ODO_FLAG_ACCEPTED on the published one means that it was used. The
 * two must not have a measurement in common with the track between them, such as a landmark that was seen throughout. */
#define ODO_RELATIVE_POSE_TRANSLATION 1u
#define ODO_RELATIVE_POSE_ROTATION 2u
typedef struct odo_relative_pose {
  odo_header header;     /* t_ns: the later time */
  int64_t t_from_ns;     /* the earlier time */
  double q_b0_b1[4];
  double p_b0_b1[3];     /* position of b1, the body at the later time, in b0, the body at the earlier time, m */
  double covariance[36]; /* of (rotation in b0, position in b0), rad^2 and m^2; always valid */
} odo_relative_pose;

/* A key frame of a map, since 1.1. The host keeps the pose of the body at its time, and corrects it with the track. It
 * remembers 1024 of each instance, the newest ones. The published one has the pose, and is published and delivered to
 * its plugin again when a recognised place has moved that by more than a correction does (odo_correction). */
typedef struct odo_key_frame {
  odo_header header;  /* t_ns: time of its frame, at most 3 s before the newest pose */
  uint64_t id;        /* number that the plugin gives it, not 0 */
  uint32_t camera;    /* header.source of its frame */
  uint32_t landmarks; /* number of landmarks that it has */
  double q_n_b[4];    /* pose of the body, estimated by the host; valid with ODO_FLAG_NAVIGATION */
  double p_n_b[3];    /* m; likewise */
} odo_key_frame;

/* Place in the map of an earlier session, since 1.1. The frame m of a map has its z axis downwards, like n. The host
 * holds the place of up to 4 maps in n, from the first of these on. A session whose place in n nothing else gives takes
 * m for n. ODO_FLAG_ACCEPTED on the published one means that it was used. */
typedef struct odo_map_pose {
  odo_header header;     /* t_ns: time of the frame that was recognised */
  uint64_t map;          /* id of the map, from its file, not 0 */
  double q_m_b[4];
  double p_m_b[3];       /* m */
  double covariance[36]; /* of (rotation in m, position in m), rad^2 and m^2: the error of this recognition */
  double map_sigma_m;    /* standard deviation of the map itself at that place, in each axis: what any number of
                          * recognitions has in common */
  double map_sigma_rad;  /* the same of its heading */
} odo_map_pose;

/* Estimated pose with its uncertainty: the output of the host. */
#define ODO_POSE_ORIENTATION 1u
#define ODO_POSE_POSITION 2u
#define ODO_POSE_VELOCITY 4u
#define ODO_POSE_METRIC 8u       /* the position is in metres; if not set, up to scale */
#define ODO_POSE_CAMERA 16u      /* pose of the camera; if not set, of the body */
#define ODO_POSE_EXTRAPOLATED 32u
#define ODO_POSE_ANGULAR_VELOCITY 64u
#define ODO_POSE_VELOCITY_COVARIANCE 128u
#define ODO_POSE_COVARIANCE 256u
#define ODO_POSE_NORTH 512u           /* the north of n is true north, to within the covariance */
#define ODO_POSE_FLOOR 1024u          /* floor and floor_probability are valid: barometer and track are available */
#define ODO_POSE_CARRIED 2048u        /* the height changes without steps: a lift or an escalator carries the user */
typedef struct odo_pose {
  odo_header header;
  double q_n[4];         /* rotates vectors from the camera (or body) to n */
  double p_n[3];         /* m */
  double velocity_n[3];  /* of the point p_n, m/s */
  double covariance[36]; /* of (rotation in n, position in n), rad^2 and m^2 */
  double scale;          /* current scale: metres = scale * displacement of the front-end; 0: unknown */
  double scale_sigma;    /* standard deviation of scale; 0: unknown */
  double distance_m;     /* distance travelled since the start */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t reason;       /* ODO_REASON_* */
  double angular_velocity[3];    /* rad/s, in the axes of the camera (or body), bias subtracted */
  double velocity_covariance[9]; /* of velocity_n, (m/s)^2; not filled by this library up to 1.0 */
  int32_t floor;                 /* latest estimate: storeys above the floor where the track started */
  uint32_t reserved;             /* 0 */
  double floor_probability;      /* probability of `floor`, 0 to 1 */
} odo_pose;

typedef struct odo_state {
  odo_header header;
  uint32_t state;
  uint32_t reason;
} odo_state;

/* A correction of the track: a point at x in the old n is at q_n * x + p_n in the new n; exact near the pose at t_ns.
 * It is published before the first corrected pose, which may have the time of an earlier pose; it may be the identity.
 * Apply it to positions derived from the track (anchors, observed objects), and rotate their axes by q_n; surveyed
 * positions (roofs, waypoints, transmitters) do not change. */
#define ODO_CORRECTION_FIX 1u       /* an absolute position or orientation was used */
#define ODO_CORRECTION_SCALE 2u     /* metric scale was determined or improved */
#define ODO_CORRECTION_RECOVERED 3u /* a component of the estimator was reset; not sent by this library up to 1.0 */
#define ODO_CORRECTION_RESTART 4u   /* the sensor clock was set back: n restarts, and the phone is where it was */
typedef struct odo_correction {
  odo_header header; /* t_ns: time of the pose at which the two agree best */
  double q_n[4];     /* rotates vectors from the old n to the new n */
  double p_n[3];     /* m */
  uint32_t reason;   /* ODO_CORRECTION_* */
  uint32_t reserved; /* 0 */
} odo_correction;

/* Camera calibration refined online by a front-end. */
#define ODO_REFINED_EXTRINSICS 1u
#define ODO_REFINED_TIME_OFFSET 2u
#define ODO_REFINED_LINE_TIME 4u
typedef struct odo_refined {
  odo_header header;
  uint32_t camera;           /* header.source of its frames */
  uint32_t model;            /* this and the following fields as in odo_calibration */
  uint32_t width;
  uint32_t height;
  uint32_t distortion_count;
  uint32_t reserved;         /* 0 */
  double fx, fy, cx, cy;
  double distortion[8];
  double q_b_c[4];
  double p_b_c[3];
  int64_t time_offset_ns;    /* in addition to the offset that the host applies to the frames of this camera */
  int64_t line_time_ns;
} odo_refined;

/* Landmarks of one frame, since 1.1. A front-end emits them before the odo_vo_motion of the frame, with its time, camera
 * and scale group. `count` elements follow the message, the most certain landmarks, spread over the picture. Element i
 * begins at the byte offset + i * stride, both multiples of 8, and counts only if it ends within struct_size. Message and
 * element may each grow: a field that is newer than 1.1 exists only if it lies before `offset`, or within `stride`
 * (ODO_HAS cannot tell). A copy of the struct alone has no elements. */
#define ODO_POINTS_METRIC 1u /* positions are in metres; if not set, in the displacement units of the scale group */
typedef struct odo_points {
  odo_header header;    /* t_ns: time of the frame */
  uint32_t camera;      /* header.source of the frame */
  uint32_t scale_group; /* as in odo_vo_motion */
  uint32_t count;       /* elements, at most ODO_MOST_POINTS */
  uint32_t stride;      /* bytes from one element to the next */
  uint32_t offset;      /* bytes from the start of the message to the first element */
  uint32_t total;       /* landmarks that the front-end had, not below `count` */
} odo_points;

#define ODO_POINT_USED 1u      /* it took part in the motion of this frame */
#define ODO_POINT_LOST 2u      /* no more seen: position and pixel are predicted; left out if the camera has passed it */
#define ODO_POINT_UNCERTAIN 4u /* its distance is not known yet: the covariance along the ray is a lower bound */
/* A landmark, an element of odo_points. */
typedef struct odo_point {
  uint64_t id;         /* the same for one landmark as long as it is tracked; never of two within a scale group */
  float p_c[3];        /* position in the camera */
  float covariance[6]; /* of p_c: xx, xy, xz, yy, yz, zz */
  float pixel[2];      /* column and row in the picture, the centre of the first pixel is 0, 0 */
  uint32_t age;        /* number of frames in which it was seen */
  uint32_t flags;      /* ODO_POINT_* */
  uint32_t reserved;   /* 0 */
} odo_point;
#define ODO_MOST_POINTS 1000u
/* Element i of `points`, an odo_points *, or null if the message does not contain it (64: its size in 1.1). */
#define ODO_POINTS_AT(points, i)                                                                                       \
  ((uint64_t)(i) < (points)->count && (points)->stride >= 64u &&                                                       \
           (uint64_t)(points)->offset + ((uint64_t)(i) + 1) * (points)->stride <= (points)->header.struct_size         \
       ? (const odo_point *)(const void *)((const char *)(points) + (points)->offset +                                 \
                                           (size_t)(i) * (points)->stride)                                             \
       : (const odo_point *)0)

/* A plane patch around the phone, since 1.1, from a surface finder. Each message replaces the one before it with its
 * source and id. Published ones have the session's id, which is never used again. Later corrections (odo_correction)
 * move it like all that is derived from the track. Vertex i of its outline begins at the byte offset + i * stride, both
 * multiples of 8, and counts only if it ends within struct_size; message and vertex may each grow, as in odo_points. */
#define ODO_SURFACE_FLOOR 1u      /* where the user stands */
#define ODO_SURFACE_HORIZONTAL 2u /* a table, a step, a ceiling */
#define ODO_SURFACE_VERTICAL 3u
#define ODO_SURFACE_OTHER 4u
#define ODO_SURFACE_PRESENT 1u    /* new, or changed */
#define ODO_SURFACE_MERGED 2u     /* part of the surface `merged_into` from now on */
#define ODO_SURFACE_WITHDRAWN 3u  /* there is no such plane */
typedef struct odo_surface {
  odo_header header;      /* t_ns: time of the newest frame that it is derived from */
  uint64_t id;            /* not 0 */
  uint64_t merged_into;   /* with MERGED: id of the other surface, otherwise 0 */
  uint32_t kind;          /* ODO_SURFACE_FLOOR ... */
  uint32_t state;         /* ODO_SURFACE_PRESENT ... */
  uint32_t count;         /* vertices, 3 to ODO_MOST_VERTICES with PRESENT, otherwise 0 */
  uint32_t stride;        /* bytes from one vertex to the next */
  uint32_t offset;        /* bytes from the start of the message to the first vertex */
  uint32_t reserved;      /* 0 */
  double q_n[4];          /* rotates vectors from the surface to n: x and y lie in the plane, z is its normal on the
                           * side that was seen. Except for refinements the axes last as long as the id */
  double p_n[3];          /* origin of its axes, a point of the plane, m */
  double sigma_m;         /* standard deviation of the plane along its normal, relative to the phone near it */
  double tilt_sigma_rad;  /* standard deviation of the normal's direction */
} odo_surface;

/* A vertex of the outline, an element of odo_surface. The outline is convex, with the interior on the left when seen
 * from the side of the normal. */
typedef struct odo_vertex {
  float p[2]; /* in the surface's x and y, m */
} odo_vertex;
#define ODO_MOST_VERTICES 32u
#define ODO_LARGEST_SURFACE 1024u /* bytes that suffice for a message with its outline */
/* Vertex i of `surface`, an odo_surface *, or null if the message does not contain it (8: its size in 1.1). */
#define ODO_VERTEX_AT(surface, i)                                                                                      \
  ((uint64_t)(i) < (surface)->count && (surface)->stride >= 8u &&                                                      \
           (uint64_t)(surface)->offset + ((uint64_t)(i) + 1) * (surface)->stride <= (surface)->header.struct_size      \
       ? (const odo_vertex *)(const void *)((const char *)(surface) + (surface)->offset +                              \
                                            (size_t)(i) * (surface)->stride)                                           \
       : (const odo_vertex *)0)

#define ODO_SEVERITY_DEBUG 0u
#define ODO_SEVERITY_INFO 1u
#define ODO_SEVERITY_WARNING 2u
#define ODO_SEVERITY_ERROR 3u

/* Message for the user or the log. Texts are UTF-8, terminated, and truncated if too long. The rate is limited to one
 * report per second for each origin and key; `count` includes the suppressed ones. */
typedef struct odo_report {
  odo_header header;  /* t_ns: newest sensor time; source: number of the instance, 0 for the host */
  uint64_t count;     /* number of reports that this one represents, including itself */
  uint32_t severity;  /* ODO_SEVERITY_* */
  int32_t status;     /* associated status code, ODO_OK if there is none */
  char plugin[64];    /* id of the plugin, or "host" */
  char key[64];       /* identifies the kind of report, e.g. "wild_imu" */
  char text[1024];    /* names the field and its value */
} odo_report;

#ifdef __cplusplus
}
#endif
#endif
