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

#define ODO_ATTITUDE_NORTH UINT32_C(1)         /* heading refers to magnetic north; without it to wherever it began */
#define ODO_ATTITUDE_MAG_DISTURBED UINT32_C(2) /* the magnetic field is not the Earth's */
#define ODO_ATTITUDE_REST UINT32_C(4)          /* the device lies still */
typedef struct odo_attitude {
  odo_header header;
  double q_n_b[4];
  double covariance_n[9]; /* of the small rotation in n, rad^2 */
  double gyro_bias_b[3];  /* rad/s, to be subtracted */
} odo_attitude;

#define ODO_MODE_UNKNOWN UINT32_C(0)
#define ODO_MODE_STATIC UINT32_C(1)
#define ODO_MODE_WALKING_TEXTING UINT32_C(2)
#define ODO_MODE_WALKING_SWINGING UINT32_C(3)
#define ODO_MODE_WALKING_POCKET UINT32_C(4)
#define ODO_MODE_STAIRS UINT32_C(5)
#define ODO_MODE_RUNNING UINT32_C(6)
#define ODO_MODE_HANDLING UINT32_C(7) /* the hand moves, the feet do not */

/* One step: one foot's fall to the other's (a stride is two of them). */
/* heading_rad is valid. Without it a step tells a length alone: `coupling: {type: inertial}` takes the direction from the
 * phone's, the default coupling moves by the camera alone, and without a camera not at all (report `no_heading`). */
#define ODO_STEP_HEADING UINT32_C(1)
typedef struct odo_step {
  odo_header header;   /* t_ns: the time up to which the estimator had looked when it was sure */
  int64_t t_start_ns;
  int64_t t_end_ns;    /* foot contact */
  double length_m;     /* horizontal */
  double sigma_m;      /* standard deviation of length_m */
  double frequency_hz; /* steps a second */
  double heading_rad;  /* walking direction in n, from north to east */
  uint32_t mode;       /* ODO_MODE_* */
  uint32_t index;      /* counts from 0 since activation */
} odo_step;

typedef struct odo_motion_mode {
  odo_header header; /* t_ns: when the mode began */
  uint32_t mode;
  uint32_t reserved; /* 0 */
} odo_motion_mode;

#define ODO_TRACKING UINT32_C(1)
#define ODO_DEGRADED UINT32_C(2)
#define ODO_LOST UINT32_C(3)
#define ODO_REASON_NONE UINT32_C(0)
#define ODO_REASON_INITIALISING UINT32_C(1)
#define ODO_REASON_TOO_DARK UINT32_C(2)
#define ODO_REASON_TOO_FAST UINT32_C(3)
#define ODO_REASON_FEW_FEATURES UINT32_C(4)
#define ODO_REASON_NO_PARALLAX UINT32_C(5)
#define ODO_REASON_NO_STEPS UINT32_C(6)
#define ODO_REASON_SENSOR_SILENT UINT32_C(7)
#define ODO_REASON_PLUGIN_FAILED UINT32_C(8)
#define ODO_REASON_NO_SCALE UINT32_C(9)

/* Camera motion since the last result, up to scale. */
#define ODO_VO_ROTATION UINT32_C(1)    /* q_c0_c1 is valid */
#define ODO_VO_TRANSLATION UINT32_C(2) /* p_c0_c1 is valid */
#define ODO_VO_COVARIANCE UINT32_C(4)
#define ODO_VO_NAVIGATION UINT32_C(8)  /* q_n_c0 is valid; set by the host, never by a front-end */
#define ODO_VO_METRIC UINT32_C(16)     /* displacements are in metres, as well as scale_sigma says */
#define ODO_VO_INERTIAL UINT32_C(32)   /* scale_sigma, velocity_c1, gravity_c1 and the biases are valid */
typedef struct odo_vo_motion {
  odo_header header;     /* t_ns: time of the later frame, c1 */
  int64_t t_from_ns;     /* time of the earlier frame, c0: the t_ns of the last result */
  double q_c0_c1[4];
  double p_c0_c1[3];     /* position of c1 in c0, up to scale */
  double covariance[36]; /* of (rotation in c0, position in c0), rad and up to scale */
  double q_n_c0[4];      /* orientation of the earlier frame as the host knows it */
  uint32_t camera;       /* calibration id */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t reason;       /* ODO_REASON_* */
  uint32_t scale_group;  /* motions of one group share one unknown scale; a new number says it changed */
  uint32_t tracked;      /* features followed from c0 to c1 */
  uint32_t inliers;      /* of them, those that agree with the motion */
  double scale_sigma;    /* relative standard deviation of the scale: common to neighbouring motions of a group */
  double velocity_c1[3]; /* of the camera at the later frame, in its axes, per second, up to scale */
  double gravity_c1[3];  /* direction of gravity in c1, downwards, unit length */
  double gyro_bias_b[3]; /* rad/s, to be subtracted */
  double accel_bias_b[3]; /* m/s^2, to be subtracted */
} odo_vo_motion;

#define ODO_SCALE_HORIZONTAL UINT32_C(1)   /* to be applied to the horizontal part of the displacement only */
#define ODO_SCALE_STEADY UINT32_C(2)       /* holds for the motions of its group that came before it too */
#define ODO_SCALE_NOT_BY_STEPS UINT32_C(4) /* does not depend on step lengths: its path may teach them */
#define ODO_SCALE_ACCEPTED UINT32_C(8)     /* set by the host on what it publishes: not too late, not of another group */
typedef struct odo_scale { /* what makes a front-end's displacements metres */
  odo_header header;
  int64_t valid_from_ns;  /* motions that end after this ... */
  int64_t valid_to_ns;    /* ... and not after this */
  double scale;           /* metres = scale * displacement */
  double sigma;           /* of scale */
  double displacement_m;  /* the metric displacement it was computed from, 0 where there is none */
  uint32_t scale_group;
  uint32_t reserved;      /* 0 */
} odo_scale;

/* A position or orientation from outside. Each component of p_n has its bit. */
#define ODO_FIX_NORTH UINT32_C(1)
#define ODO_FIX_EAST UINT32_C(2)
#define ODO_FIX_DOWN UINT32_C(4)
#define ODO_FIX_YAW UINT32_C(8)
#define ODO_FIX_ORIENTATION UINT32_C(16)
/* Latitude and longitude are valid and p_n is not: the host converts, having the origin. North and east are then known
 * without their flags; the height counts where ODO_FIX_DOWN is set as well. */
#define ODO_FIX_GEODETIC UINT32_C(32)
#define ODO_FIX_SLANT UINT32_C(64)    /* landmark_n and slant_distance_m are valid */
#define ODO_FIX_ACCEPTED UINT32_C(128) /* it was used; set by the host on what it publishes, never by a fixer */
typedef struct odo_fix {
  odo_header header;
  double p_n[3];
  double covariance_n[9];        /* of p_n, m^2 */
  double q_n_b[4];
  double orientation_cov_n[9];   /* rad^2 */
  double yaw_rad;                /* heading of the body's y axis (a phone's top) in n */
  double yaw_sigma_rad;
  double latitude_rad;
  double longitude_rad;
  double height_m;               /* ellipsoidal */
  double integrity;              /* probability that the error is larger than the covariance can explain */
  double landmark_n[3];          /* a known point in view of the camera, such as a roof's edge, m */
  double slant_distance_m;       /* from the camera to it */
} odo_fix;

/* The answer: a metric pose with its uncertainty. */
#define ODO_POSE_ORIENTATION UINT32_C(1)
#define ODO_POSE_POSITION UINT32_C(2)
#define ODO_POSE_VELOCITY UINT32_C(4)
#define ODO_POSE_METRIC UINT32_C(8)       /* position is in metres; without it up to scale */
#define ODO_POSE_CAMERA UINT32_C(16)      /* of the camera; without it of the body */
#define ODO_POSE_EXTRAPOLATED UINT32_C(32)
#define ODO_POSE_ANGULAR_VELOCITY UINT32_C(64)
#define ODO_POSE_VELOCITY_COVARIANCE UINT32_C(128)
typedef struct odo_pose {
  odo_header header;
  double q_n[4];         /* camera (or body) to n */
  double p_n[3];         /* m */
  double velocity_n[3];  /* m/s */
  double covariance[36]; /* of (rotation in n, position in n), rad^2 and m^2 */
  double scale;          /* in use: metres = scale * the front-end's displacement; 0 unknown */
  double scale_sigma;
  double distance_m;     /* travelled since the start */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t reason;       /* ODO_REASON_* */
  double angular_velocity[3];    /* rad/s, in the pose's own axes (camera or body), bias subtracted */
  double velocity_covariance[9]; /* of velocity_n, (m/s)^2 */
} odo_pose;

typedef struct odo_state {
  odo_header header;
  uint32_t state;
  uint32_t reason;
} odo_state;

/* The track was corrected and n with it: what was at x in the old n is at q_n * x + p_n in the new one. Given before the
 * pose that it corrected; whoever keeps places in n (anchors) moves them by it, and turns them by q_n. */
#define ODO_CORRECTION_FIX UINT32_C(1)       /* a position or orientation from outside */
#define ODO_CORRECTION_SCALE UINT32_C(2)     /* the metre became known, or better known */
#define ODO_CORRECTION_RECOVERED UINT32_C(3) /* a part of the estimate was started anew */
#define ODO_CORRECTION_RESTART UINT32_C(4)   /* the sensor clock was set back: n begins anew, where the phone was */
typedef struct odo_correction {
  odo_header header; /* t_ns: of the pose at which the two agree best */
  double q_n[4];     /* old n to new n, about the vertical */
  double p_n[3];     /* m */
  uint32_t reason;   /* ODO_CORRECTION_* */
  uint32_t reserved; /* 0 */
} odo_correction;

#define ODO_SEVERITY_DEBUG UINT32_C(0)
#define ODO_SEVERITY_INFO UINT32_C(1)
#define ODO_SEVERITY_WARNING UINT32_C(2)
#define ODO_SEVERITY_ERROR UINT32_C(3)

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
