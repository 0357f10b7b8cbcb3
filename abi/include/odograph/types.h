/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: the values that cross the border.
 *
 * One message protocol serves live input, recording, replay, plugins and bindings: every sample that goes in and every
 * event that comes out is a struct that starts with an `odo_header`.
 *
 * Rules that hold for every struct here
 *  - It starts with `uint32_t struct_size`, the size its writer knew. Fields are only ever appended; a reader asks
 *    ODO_HAS(pointer, field) before it touches a field that did not exist in version 1.0 (the sizes of which are in
 *    messages.h). What is smaller than version 1.0 is refused, what is larger than the reader's struct is passed on whole.
 *  - No pointer is ever appended to a message: who passes it on need not understand it.
 *  - A number out of a list (a mode, a reason, a state, a format) may be newer than its reader: docs/abi.md says for each
 *    list what an unknown one counts as.
 *  - Fixed-width integers, float, double and pointers only; padding is explicit and zero; layout.h pins every offset.
 *  - A value is valid when its bit in `header.flags` says so, never by being or not being NaN.
 *  - SI units and radians. Time is int64_t nanoseconds of the sensor clock (any epoch, one clock for all sensors).
 *  - Frames: n = local North-East-Down, b = body (the IMU's axes), c = camera (x right, y down, z forward).
 *    R_n_c takes vectors from c to n, p_n_c is the camera's position in n.
 *  - Quaternions are Hamilton, stored w, x, y, z: q_n_b rotates vectors from b to n. Matrices are row-major.
 */
#ifndef ODOGRAPH_TYPES_H
#define ODOGRAPH_TYPES_H

#include <stddef.h>
#include <stdint.h>

/* One layout for all: pointers of 8 bytes, everything aligned to its own size. */
#if UINTPTR_MAX != UINT64_MAX
#error "Odograph's ABI is for 64-bit targets: a struct with pointers would be laid out otherwise here"
#endif

/* How functions are called across the border. Windows compilers may be told to use another convention by default. */
#if defined(_WIN32)
#define ODO_CALL __cdecl
#else
#define ODO_CALL
#endif

/* ODO_EXPORT: what a plugin exports, its entry. ODO_API: what the library exports and an app imports. */
#if defined(_WIN32)
#define ODO_EXPORT __declspec(dllexport)
#if defined(ODO_BUILDING_LIBRARY)
#define ODO_API __declspec(dllexport)
#else
#define ODO_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define ODO_EXPORT __attribute__((visibility("default")))
#define ODO_API ODO_EXPORT
#else
#define ODO_EXPORT
#define ODO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The ABI spoken by these headers. A break raises the major and renames the entry symbol; an addition raises the minor.
 * Major 0 is a draft: host and plugin must be of the same draft, which is the minor. The freeze makes it 1.0. */
#define ODO_ABI_MAJOR UINT32_C(0)
#define ODO_ABI_MINOR UINT32_C(2)

/* True when the struct behind `ptr` is large enough to hold `field`. Its first member is, by rule, its size. */
#define ODO_HAS(ptr, field)                                                                                            \
  ((uint64_t)((const char *)&(ptr)->field - (const char *)(ptr)) + sizeof((ptr)->field) <=                             \
   (uint64_t) * (const uint32_t *)(const void *)(ptr))

/* ---- status codes -------------------------------------------------------------------------------------------------
 * Zero is success. Each failure has a stated effect on the instance that returned it. */
#define ODO_OK 0
#define ODO_NOT_READY 1         /* no output yet; nothing is wrong and the state is as it was */
#define ODO_E_ARGUMENT (-1)     /* the caller broke the contract; discarded, state unchanged */
#define ODO_E_DISCARD (-2)      /* the input was unusable; discarded, state unchanged */
#define ODO_E_EXHAUSTED (-3)    /* a quota or a buffer is used up; discarded, state unchanged */
#define ODO_E_UNSUPPORTED (-4)  /* not offered by this side; state unchanged */
#define ODO_E_STRUCT_SIZE (-5)  /* a struct is smaller than version 1.0 of it; state unchanged */
#define ODO_E_VERSION (-6)      /* no common ABI version; nothing was created */
#define ODO_E_STATE (-7)        /* called in the wrong state; state unchanged */
#define ODO_E_CONFIG (-8)       /* configuration refused; the instance stays unconfigured */
#define ODO_E_NOT_FOUND (-9)    /* no such file, plugin, key or time; state unchanged */
#define ODO_E_DATA (-10)        /* a file or blob is damaged; state unchanged */
#define ODO_E_MEMORY (-11)      /* out of memory; the instance needs reset or load */
#define ODO_E_ERROR (-12)       /* the instance needs reset or load before it works again */
#define ODO_E_FATAL (-13)       /* the whole library is quarantined */

/* A UTF-8 string that is not terminated and not owned. Frozen at 16 bytes; embedded by value in other structs. */
typedef struct odo_string {
  const char *data; /* may be null when size is 0 */
  uint64_t size;    /* bytes */
} odo_string;

/* ---- messages ----------------------------------------------------------------------------------------------------- */
/* Numbers by range: 0 is none, 0x1 to 0xFFF are inputs, 0x1000 to 0x1FFF events, up to 0x7FFFFFFF reserved, and the upper
 * half belongs to vendors. What a host does not know and is not an event, it takes, puts into order, records and hands to
 * the plugins that declare it. */
#define ODO_TYPE_IMU UINT32_C(0x1)
#define ODO_TYPE_MAGNETOMETER UINT32_C(0x2)
#define ODO_TYPE_BAROMETER UINT32_C(0x3)
#define ODO_TYPE_GNSS UINT32_C(0x4)
#define ODO_TYPE_FRAME UINT32_C(0x5)
#define ODO_TYPE_CALIBRATION UINT32_C(0x6)
#define ODO_TYPE_IMU_NOISE UINT32_C(0x7)
#define ODO_TYPE_WAYPOINT UINT32_C(0x8)
#define ODO_TYPE_ATTITUDE UINT32_C(0x1001)
#define ODO_TYPE_STEP UINT32_C(0x1002)
#define ODO_TYPE_MOTION_MODE UINT32_C(0x1003)
#define ODO_TYPE_VO_MOTION UINT32_C(0x1004)
#define ODO_TYPE_SCALE UINT32_C(0x1005)
#define ODO_TYPE_FIX UINT32_C(0x1006)
#define ODO_TYPE_POSE UINT32_C(0x1007)
#define ODO_TYPE_STATE UINT32_C(0x1008)
#define ODO_TYPE_CORRECTION UINT32_C(0x1009)
#define ODO_TYPE_REPORT UINT32_C(0x100A)

/* A vendor's own message: `vendor` (below 2^19) as docs/abi.md says, `number` (below 4096) as the vendor likes. It starts
 * with an odo_header, has at most ODO_LARGEST_MESSAGE bytes and no pointer: it is copied, recorded and replayed. Vendor 0
 * is for experiments. */
#define ODO_TYPE_VENDOR(vendor, number)                                                                                \
  (UINT32_C(0x80000000) | ((uint32_t)(vendor) & UINT32_C(0x7FFFF)) << 12 | ((uint32_t)(number) & UINT32_C(0xFFF)))
#define ODO_IS_EVENT(type) (((uint32_t)(type) >> 12) == 1)
#define ODO_IS_VENDOR(type) (((uint32_t)(type) >> 31) == 1)
#define ODO_LARGEST_MESSAGE UINT32_C(65536)

/* The head of every message. Frozen at 32 bytes; a message grows at its end. */
typedef struct odo_header {
  uint32_t struct_size; /* bytes of the whole message, as its writer knew it */
  uint32_t type;        /* ODO_TYPE_* */
  int64_t t_ns;         /* time the message is valid for; for a frame the middle of the exposure of the middle row */
  uint32_t source;      /* who made it: sensor index on input; on events the instance number, filled in by the host */
  uint32_t flags;       /* validity bits of this type */
  float quality;        /* 0 (worthless) to 1 (as good as it gets); 0 also where the writer does not say */
  uint32_t reserved;    /* 0 */
} odo_header;

/* Copies a message into the reader's own struct of `size` bytes, where `*mine = *message` would read behind the end of an
 * older and smaller one. What its writer did not know reads as zero and ODO_HAS still says no; the end of a newer and
 * larger one is left out. */
static inline void odo_copy(void *mine, uint32_t size, const odo_header *message) {
  const uint32_t there = message->struct_size < size ? message->struct_size : size;
  const unsigned char *from = (const unsigned char *)(const void *)message;
  unsigned char *to = (unsigned char *)mine;
  uint32_t i;
  for (i = 0; i < size; ++i) to[i] = (unsigned char)(i < there ? from[i] : 0);
  *(uint32_t *)mine = there;
}

/* Inertial sample. A phone that delivers the two sensors apart sends two samples, each with one bit set: the host joins
 * them by interpolating the accelerometer at the gyroscope's times. */
#define ODO_IMU_GYRO UINT32_C(1)
#define ODO_IMU_ACCEL UINT32_C(2)
typedef struct odo_imu {
  odo_header header;
  double gyro_b[3];  /* rad/s */
  double accel_b[3]; /* specific force, m/s^2: about +9.81 upwards at rest */
} odo_imu;

#define ODO_MAGNETOMETER_SIGMA UINT32_C(1)
typedef struct odo_magnetometer {
  odo_header header;
  double field_b[3]; /* magnetic flux density, tesla */
  double sigma_t;    /* standard deviation of each component, tesla; valid with ODO_MAGNETOMETER_SIGMA */
} odo_magnetometer;

#define ODO_BAROMETER_SIGMA UINT32_C(1)
typedef struct odo_barometer {
  odo_header header;
  double pressure_pa;
  double sigma_pa; /* standard deviation, Pa; valid with ODO_BAROMETER_SIGMA */
} odo_barometer;

#define ODO_GNSS_POSITION UINT32_C(1)
#define ODO_GNSS_HEIGHT UINT32_C(2)
#define ODO_GNSS_COVARIANCE UINT32_C(4)
#define ODO_GNSS_VELOCITY UINT32_C(8)
typedef struct odo_gnss {
  odo_header header;
  double latitude_rad;      /* geodetic, WGS 84 */
  double longitude_rad;     /* WGS 84 */
  double height_m;          /* above the WGS 84 ellipsoid */
  double covariance_n[9];   /* of the position in n, m^2 */
  double velocity_n[3];     /* m/s */
  uint32_t satellites;      /* used in the solution, 0 unknown */
  uint32_t reserved;        /* 0 */
} odo_gnss;

/* One plane of a picture. Frozen at 24 bytes. */
typedef struct odo_plane {
  const uint8_t *data;   /* first pixel of the first row */
  int64_t row_stride;    /* bytes from one row to the next */
  uint32_t pixel_stride; /* bytes from one pixel (or chroma pair) to the next */
  uint32_t reserved;     /* 0 */
} odo_plane;

#define ODO_FORMAT_GREY8 UINT32_C(1)
#define ODO_FORMAT_NV12 UINT32_C(2)  /* plane 0 luma, plane 1 interleaved U V, both at half size */
#define ODO_FORMAT_NV21 UINT32_C(3)  /* plane 0 luma, plane 1 interleaved V U, both at half size */
#define ODO_FORMAT_RGB8 UINT32_C(4)
#define ODO_FORMAT_RGBA8 UINT32_C(5)
#define ODO_FORMAT_YUV420 UINT32_C(6) /* planes 0 luma, 1 U, 2 V, both at half size; any pixel stride (Android's YUV_420_888) */
#define ODO_FORMAT_BGRA8 UINT32_C(7)

/* A borrowed camera frame. The pixels belong to whoever made the frame and are lent for the duration of the call.
 * To keep them longer, call retain (it may answer ODO_E_EXHAUSTED when too many are held), keep a copy of the struct
 * (odo_copy) and later call release with that copy, once for each retain; both may be called on any thread. A frame
 * without retain cannot be kept. */
#define ODO_FRAME_EXPOSURE UINT32_C(1)
#define ODO_FRAME_LINE_TIME UINT32_C(2)
#define ODO_FRAME_MASK UINT32_C(4)
#define ODO_FRAME_INTRINSICS UINT32_C(8) /* fx, fy, cx, cy of this frame stand above its calibration's (autofocus) */
typedef struct odo_frame {
  odo_header header;
  uint32_t format;      /* ODO_FORMAT_* */
  uint32_t calibration; /* id of the odo_calibration that describes the camera */
  uint32_t width;       /* pixels */
  uint32_t height;      /* pixels */
  odo_plane planes[4];
  odo_plane mask;       /* grey8 of the frame's size, 0 = do not use this pixel */
  int64_t exposure_ns;  /* duration */
  int64_t line_time_ns; /* rolling shutter: from one row's exposure to the next's; 0 = global shutter */
  void *owner;          /* for retain and release alone */
  int32_t (ODO_CALL *retain)(const struct odo_frame *frame);  /* [any] ODO_OK or ODO_E_EXHAUSTED; null = cannot be kept */
  void (ODO_CALL *release)(const struct odo_frame *frame);    /* [any] */
  double fx;            /* pixels; valid with ODO_FRAME_INTRINSICS */
  double fy;
  double cx;            /* of the pixel centre, as in odo_calibration */
  double cy;
} odo_frame;

/* Camera calibration; sent before the first frame that names its id, and again whenever it changes. */
#define ODO_CAMERA_PINHOLE UINT32_C(1)        /* radial-tangential; distortion k1 k2 p1 p2 [k3 [k4 k5 k6]] as in OpenCV */
#define ODO_CAMERA_KANNALA_BRANDT UINT32_C(2) /* fisheye; distortion k1 k2 k3 k4 (Kannala & Brandt 2006, as in OpenCV) */
#define ODO_CALIBRATION_EXTRINSICS UINT32_C(1)
#define ODO_CALIBRATION_TIME_OFFSET UINT32_C(2)
#define ODO_CALIBRATION_LINE_TIME UINT32_C(4)
#define ODO_CALIBRATION_REFINED UINT32_C(8) /* an event: what a front-end has refined the camera to, while running */
typedef struct odo_calibration {
  odo_header header;
  uint32_t id;
  uint32_t model; /* ODO_CAMERA_* */
  uint32_t width;
  uint32_t height;
  double fx, fy, cx, cy;     /* pixels; the centre of the first pixel is (0, 0) */
  double distortion[8];
  uint32_t distortion_count; /* 0, 4, 5 or 8 */
  uint32_t reserved;         /* 0 */
  double q_b_c[4];           /* camera to body */
  double p_b_c[3];           /* camera's position in b, m */
  int64_t time_offset_ns;    /* IMU time = camera time + time_offset_ns */
  int64_t line_time_ns;      /* rolling shutter: from one row's exposure to the next's */
} odo_calibration;

/* IMU noise as an Allan deviation gives it. */
typedef struct odo_imu_noise {
  odo_header header;
  double gyro_noise;  /* rad/s/sqrt(Hz) */
  double gyro_walk;   /* rad/s^2/sqrt(Hz) */
  double accel_noise; /* m/s^2/sqrt(Hz) */
  double accel_walk;  /* m/s^3/sqrt(Hz) */
} odo_imu_noise;

/* "The user is at this place now": a tap on a map, a surveyed mark. */
#define ODO_WAYPOINT_VERTICAL UINT32_C(1) /* p_n[2] is valid too */
typedef struct odo_waypoint {
  odo_header header;
  double p_n[3]; /* m */
  double sigma_m;
} odo_waypoint;

/* ---- events ------------------------------------------------------------------------------------------------------- */
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
#define ODO_VO_METRIC UINT32_C(16)     /* the VO unit is the metre, as well as scale_sigma says */
#define ODO_VO_INERTIAL UINT32_C(32)   /* scale_sigma, velocity_c1, gravity_c1 and the biases are valid */
typedef struct odo_vo_motion {
  odo_header header;     /* t_ns: time of the later frame, c1 */
  int64_t t_from_ns;     /* time of the earlier frame, c0: the t_ns of the last result */
  double q_c0_c1[4];
  double p_c0_c1[3];     /* position of c1 in c0, VO units */
  double covariance[36]; /* of (rotation in c0, position in c0), rad and VO units */
  double q_n_c0[4];      /* orientation of the earlier frame as the host knows it */
  uint32_t camera;       /* calibration id */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t reason;       /* ODO_REASON_* */
  uint32_t scale_group;  /* motions of one group share one unknown unit; a new number says the unit changed */
  uint32_t tracked;      /* features followed from c0 to c1 */
  uint32_t inliers;      /* of them, those that agree with the motion */
  double scale_sigma;    /* relative standard deviation of the unit: common to neighbouring motions of a group */
  double velocity_c1[3]; /* of the camera at the later frame, in its axes, VO units/s */
  double gravity_c1[3];  /* direction of gravity in c1, downwards, unit length */
  double gyro_bias_b[3]; /* rad/s, to be subtracted */
  double accel_bias_b[3]; /* m/s^2, to be subtracted */
} odo_vo_motion;

#define ODO_SCALE_HORIZONTAL UINT32_C(1)   /* to be applied to the horizontal part of the displacement only */
#define ODO_SCALE_STEADY UINT32_C(2)       /* holds for the motions of its group that came before it too */
#define ODO_SCALE_NOT_BY_STEPS UINT32_C(4) /* does not depend on step lengths: its path may teach them */
#define ODO_SCALE_ACCEPTED UINT32_C(8)     /* set by the host on what it publishes: not too late, not of another group */
typedef struct odo_scale { /* how long a VO unit is */
  odo_header header;
  int64_t valid_from_ns;  /* motions that end after this ... */
  int64_t valid_to_ns;    /* ... and not after this */
  double metres_per_unit;
  double sigma;           /* of metres_per_unit */
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
#define ODO_POSE_METRIC UINT32_C(8)       /* position is in metres; without it in VO units */
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
  double scale;          /* metres per VO unit in use, 0 unknown */
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
