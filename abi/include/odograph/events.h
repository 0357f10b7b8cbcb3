/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: what comes out, the events of plugins and of the host. base.h has the rules.
 */
#ifndef ODOGRAPH_EVENTS_H
#define ODOGRAPH_EVENTS_H

#include <odograph/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Heading refers to magnetic north; without this or TRUE_NORTH to any direction. The host, where it has the declination,
 * rotates such an attitude to true north before it publishes it and hands it on, and sets TRUE_NORTH instead. */
#define ODO_ATTITUDE_MAGNETIC_NORTH 1u
#define ODO_ATTITUDE_MAG_DISTURBED 2u /* the magnetic field is not the Earth's */
#define ODO_ATTITUDE_REST 4u          /* the device lies still */
#define ODO_ATTITUDE_TRUE_NORTH 8u
#define ODO_ATTITUDE_COVARIANCE 16u
#define ODO_ATTITUDE_GYRO_BIAS 32u
typedef struct odo_attitude {
  odo_header header;
  double q_n_b[4];        /* always valid */
  double covariance_n[9]; /* of the rotation in n, rad^2 */
  double gyro_bias_b[3];  /* rad/s, to be subtracted */
} odo_attitude;

#define ODO_MODE_UNKNOWN 0u
#define ODO_MODE_STATIC 1u
#define ODO_MODE_WALKING_TEXTING 2u
#define ODO_MODE_WALKING_SWINGING 3u
#define ODO_MODE_WALKING_POCKET 4u
#define ODO_MODE_STAIRS 5u
#define ODO_MODE_RUNNING 6u
#define ODO_MODE_HANDLING 7u /* the hand moves, the feet do not */

/* One step: one foot's fall to the other's (a stride is two of them). Without ODO_STEP_HEADING it is a length alone:
 * `coupling: {type: localizer}` takes the direction from the phone's, the default coupling moves by the camera alone, and
 * without a camera not at all (report `no_heading`). */
#define ODO_STEP_HEADING 1u
#define ODO_STEP_HEADING_SIGMA 2u
typedef struct odo_step {
  odo_header header;   /* t_ns: the newest sample that the decision needed */
  int64_t t_start_ns;
  int64_t t_end_ns;    /* foot contact */
  double length_m;     /* horizontal */
  double sigma_m;      /* standard deviation of length_m; always valid */
  double frequency_hz; /* steps a second */
  double heading_rad;  /* walking direction in n, from north to east */
  uint32_t mode;       /* ODO_MODE_* */
  uint32_t index;      /* counts from 0 since activation */
  double heading_sigma_rad; /* standard deviation of heading_rad */
} odo_step;

typedef struct odo_motion_mode {
  odo_header header; /* t_ns: when the mode began */
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

/* Camera motion since the last result, up to scale. */
#define ODO_VO_ROTATION 1u    /* q_c0_c1 is valid */
#define ODO_VO_TRANSLATION 2u /* p_c0_c1 is valid */
#define ODO_VO_COVARIANCE 4u
#define ODO_VO_METRIC 8u       /* displacements are in metres, to within scale_sigma, which is valid */
#define ODO_VO_INERTIAL 16u    /* scale_sigma, velocity_c1, gravity_c1 and the biases are valid */
typedef struct odo_vo_motion {
  odo_header header;     /* t_ns: time of the later frame, c1 */
  int64_t t_from_ns;     /* time of the earlier frame, c0: the t_ns of the last result, also of one that was lost */
  double q_c0_c1[4];
  double p_c0_c1[3];     /* position of c1 in c0, up to scale */
  double covariance[36]; /* of (rotation in c0, position in c0), rad^2 and displacement units^2 */
  double q_n_c0[4];      /* orientation of the earlier frame as the host estimates it; valid with ODO_FLAG_NAVIGATION */
  uint32_t camera;       /* header.source of its frames */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t reason;       /* ODO_REASON_* */
  uint32_t scale_group;  /* motions of one group share one unknown scale; a new number where it changed */
  uint32_t tracked;      /* features followed from c0 to c1 */
  uint32_t inliers;      /* of them, those that agree with the motion */
  double scale_sigma;    /* relative standard deviation of the scale: common to neighbouring motions of a group */
  double velocity_c1[3]; /* of the camera at the later frame, in its axes, per second, up to scale */
  double gravity_c1[3];  /* direction of gravity in c1, downwards, unit length */
  double gyro_bias_b[3]; /* rad/s, to be subtracted */
  double accel_bias_b[3]; /* m/s^2, to be subtracted */
} odo_vo_motion;

#define ODO_SCALE_HORIZONTAL 1u   /* to be applied to the horizontal part of the displacement only */
#define ODO_SCALE_STEADY 2u       /* holds for the motions of its group that came before it too */
#define ODO_SCALE_NOT_BY_STEPS 4u /* does not depend on step lengths: its displacement may calibrate them */
/* What makes a front-end's displacements metres. ODO_FLAG_ACCEPTED on what the host publishes: not too late, and of the
 * present group. */
typedef struct odo_scale {
  odo_header header;
  int64_t valid_from_ns;  /* motions that end after this ... */
  int64_t valid_to_ns;    /* ... and not after this */
  double scale;           /* metres = scale * displacement */
  double sigma;           /* standard deviation of scale; always valid */
  double displacement_m;  /* the metric displacement it was computed from, 0 where there is none */
  uint32_t scale_group;
  uint32_t reserved;      /* 0 */
} odo_scale;

/* A position or orientation from outside. Each component of p_n has its bit. A position needs ODO_FIX_COVARIANCE, an
 * orientation ODO_FIX_ORIENTATION_COVARIANCE: the host refuses one without (ODO_E_ARGUMENT). ODO_FLAG_ACCEPTED on what the
 * host publishes: it was used. */
#define ODO_FIX_NORTH 1u
#define ODO_FIX_EAST 2u
#define ODO_FIX_DOWN 4u
#define ODO_FIX_YAW 8u           /* yaw_rad, yaw_sigma_rad and yaw_axis_b are valid */
#define ODO_FIX_ORIENTATION 16u
/* Latitude and longitude are valid and p_n is not: the host converts, having the origin. North and east are then valid
 * without their bits; the height counts where ODO_FIX_DOWN is set as well. */
#define ODO_FIX_GEODETIC 32u
#define ODO_FIX_SLANT 64u        /* landmark_n and slant_distance_m are valid */
#define ODO_FIX_COVARIANCE 128u
#define ODO_FIX_ORIENTATION_COVARIANCE 256u
#define ODO_FIX_INTEGRITY 512u
#define ODO_FIX_LEVER 1024u      /* without it p_n is the position of b's origin */
#define ODO_FIX_CROSS_COVARIANCE 2048u
#define ODO_FIX_SLANT_SIGMA 4096u
typedef struct odo_fix {
  odo_header header;
  double p_n[3];                 /* position in n of the point lever_b, m */
  double covariance_n[9];        /* of p_n, m^2 */
  double q_n_b[4];
  double orientation_cov_n[9];   /* of the rotation in n, rad^2 */
  double yaw_rad;                /* heading of the horizontal part of yaw_axis_b, from north to east */
  double yaw_sigma_rad;          /* standard deviation of it */
  double latitude_rad;           /* of the point lever_b */
  double longitude_rad;
  double height_m;               /* ellipsoidal */
  double integrity;              /* probability that the error is larger than the covariance can explain */
  double landmark_n[3];          /* a surveyed point in view of the camera, such as a roof's edge, m */
  double slant_distance_m;       /* from the camera to it */
  double lever_b[3];             /* the point in b that the position is of (a camera, an antenna), m */
  double yaw_axis_b[3];          /* unit vector in b: (0, 1, 0) is a phone's top, (0, 0, -1) its back, which suits one held upright */
  double cross_covariance_n[9];  /* of rotation (rows) and position (columns), rad m */
  double slant_sigma_m;          /* standard deviation of slant_distance_m */
} odo_fix;

/* The relative pose of the body at two times, as a loop closure or another map gives it. Published, recorded and given to the
 * plugins that declare it; the host's estimate does not use it yet. */
#define ODO_RELATIVE_POSE_TRANSLATION 1u
#define ODO_RELATIVE_POSE_ROTATION 2u
typedef struct odo_relative_pose {
  odo_header header;     /* t_ns: the later time */
  int64_t t_from_ns;     /* the earlier time */
  double q_b0_b1[4];
  double p_b0_b1[3];     /* position of b at the later time in b at the earlier one, m */
  double covariance[36]; /* of (rotation in b0, position in b0), rad^2 and m^2; always valid */
} odo_relative_pose;

/* The answer: a metric pose with its uncertainty. */
#define ODO_POSE_ORIENTATION 1u
#define ODO_POSE_POSITION 2u
#define ODO_POSE_VELOCITY 4u
#define ODO_POSE_METRIC 8u       /* position is in metres; without it up to scale */
#define ODO_POSE_CAMERA 16u      /* of the camera; without it of the body */
#define ODO_POSE_EXTRAPOLATED 32u
#define ODO_POSE_ANGULAR_VELOCITY 64u
#define ODO_POSE_VELOCITY_COVARIANCE 128u
#define ODO_POSE_COVARIANCE 256u
#define ODO_POSE_NORTH 512u           /* n's north is true north, to within the covariance */
#define ODO_POSE_FLOOR 1024u          /* floor and floor_probability are valid: there is a barometer and a track */
#define ODO_POSE_CARRIED 2048u        /* a lift or an escalator carries the user up or down, who takes no step */
typedef struct odo_pose {
  odo_header header;
  double q_n[4];         /* camera (or body) to n */
  double p_n[3];         /* m */
  double velocity_n[3];  /* m/s */
  double covariance[36]; /* of (rotation in n, position in n), rad^2 and m^2 */
  double scale;          /* in use: metres = scale * the front-end's displacement; 0 unknown */
  double scale_sigma;    /* standard deviation of scale, 0 where scale is unknown */
  double distance_m;     /* travelled since the start */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t reason;       /* ODO_REASON_* */
  double angular_velocity[3];    /* rad/s, in the pose's own axes (camera or body), bias subtracted */
  double velocity_covariance[9]; /* of velocity_n, (m/s)^2 */
  int32_t floor;                 /* the newest known: storeys above the floor where the track began */
  uint32_t reserved;             /* 0 */
  double floor_probability;      /* of that number, 0 to 1 */
} odo_pose;

typedef struct odo_state {
  odo_header header;
  uint32_t state;
  uint32_t reason;
} odo_state;

/* The track was corrected and n with it: what was at x in the old n is at q_n * x + p_n in the new one. Given before the
 * pose that it corrected. Places that were found from the track (anchors, seen objects) move by it and are rotated by q_n; surveyed
 * places (roofs, waypoints, transmitters) stay. */
#define ODO_CORRECTION_FIX 1u       /* a position or orientation from outside */
#define ODO_CORRECTION_SCALE 2u     /* the metre became known, or better known */
#define ODO_CORRECTION_RECOVERED 3u /* a part of the estimate was started anew */
#define ODO_CORRECTION_RESTART 4u   /* the sensor clock was set back: n begins anew, where the phone was */
typedef struct odo_correction {
  odo_header header; /* t_ns: of the pose at which the two agree best */
  double q_n[4];     /* old n to new n, about the vertical */
  double p_n[3];     /* m */
  uint32_t reason;   /* ODO_CORRECTION_* */
  uint32_t reserved; /* 0 */
} odo_correction;

/* What a front-end has refined the calibration of a camera to, while running. */
#define ODO_REFINED_EXTRINSICS 1u
#define ODO_REFINED_TIME_OFFSET 2u
#define ODO_REFINED_LINE_TIME 4u
typedef struct odo_refined {
  odo_header header;
  uint32_t camera;           /* header.source of its frames */
  uint32_t model;            /* as in odo_calibration, and so on */
  uint32_t width;
  uint32_t height;
  uint32_t distortion_count;
  uint32_t reserved;         /* 0 */
  double fx, fy, cx, cy;
  double distortion[8];
  double q_b_c[4];
  double p_b_c[3];
  int64_t time_offset_ns;    /* beyond the offset that the host applies to this camera's frames */
  int64_t line_time_ns;
} odo_refined;

#define ODO_SEVERITY_DEBUG 0u
#define ODO_SEVERITY_INFO 1u
#define ODO_SEVERITY_WARNING 2u
#define ODO_SEVERITY_ERROR 3u

/* Something that a person should know. Texts are UTF-8, terminated, and cut off where they are too long. Of equal origin
 * and key at most one a second is given; `count` says how many that one stands for. */
typedef struct odo_report {
  odo_header header;  /* t_ns: the newest sensor time; source: the instance's number, 0 for the host */
  uint64_t count;     /* reports that this one stands for, itself among them */
  uint32_t severity;  /* ODO_SEVERITY_* */
  int32_t status;     /* the status code that belongs to it, ODO_OK where there is none */
  char plugin[64];    /* the plugin's id, or "host" */
  char key[64];       /* equal for reports of one kind: "wild_imu" */
  char text[1024];    /* names the field and its value */
} odo_report;

#ifdef __cplusplus
}
#endif
#endif
