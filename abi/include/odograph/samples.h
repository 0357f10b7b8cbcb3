/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: inputs, which are samples of sensors and descriptions of sensors. base.h has the rules.
 */
#ifndef ODOGRAPH_SAMPLES_H
#define ODOGRAPH_SAMPLES_H

#include <odograph/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Copies a message into the reader's own struct of `size` bytes, where `*mine = *message` would read behind the end of an
 * older and smaller one. Fields that its writer did not have are zero and ODO_HAS is false for them; the end of a newer and
 * larger one is left out. */
static inline void odo_copy(void *mine, uint32_t size, const odo_header *message) {
  const uint32_t available = message->struct_size < size ? message->struct_size : size;
  const unsigned char *from = (const unsigned char *)(const void *)message;
  unsigned char *to = (unsigned char *)mine;
  uint32_t i;
  for (i = 0; i < size; ++i) to[i] = (unsigned char)(i < available ? from[i] : 0);
  *(uint32_t *)mine = available;
}

/* Inertial sample. A phone that delivers the two sensors separately sends two samples, each with one bit set: the host joins
 * them by interpolating the accelerometer at the gyroscope's times. Without the CORRECTED bits the values are as the sensor
 * measures them (Android's *_UNCALIBRATED, raw Core Motion data). */
#define ODO_IMU_GYRO 1u
#define ODO_IMU_ACCEL 2u
#define ODO_IMU_GYRO_CORRECTED 4u  /* the operating system subtracts its estimate of the bias */
#define ODO_IMU_ACCEL_CORRECTED 8u
typedef struct odo_imu {
  odo_header header;
  double gyro_b[3];  /* rad/s */
  double accel_b[3]; /* specific force, m/s^2: about +9.81 upwards at rest */
} odo_imu;

#define ODO_MAGNETOMETER_SIGMA 1u
#define ODO_MAGNETOMETER_CORRECTED 2u /* the operating system subtracts its estimate of the hard iron */
typedef struct odo_magnetometer {
  odo_header header;
  double field_b[3]; /* magnetic flux density, tesla */
  double sigma_t;    /* standard deviation of each component, tesla; valid with ODO_MAGNETOMETER_SIGMA */
} odo_magnetometer;

#define ODO_BAROMETER_SIGMA 1u
typedef struct odo_barometer {
  odo_header header;
  double pressure_pa;
  double sigma_pa; /* standard deviation, Pa; valid with ODO_BAROMETER_SIGMA */
} odo_barometer;

#define ODO_GNSS_POSITION 1u
#define ODO_GNSS_HEIGHT 2u
#define ODO_GNSS_COVARIANCE 4u
#define ODO_GNSS_VELOCITY 8u
#define ODO_GNSS_LEVER 16u /* without it the antenna is at b's origin */
typedef struct odo_gnss {
  odo_header header;
  double latitude_rad;      /* geodetic, WGS 84 */
  double longitude_rad;     /* WGS 84 */
  double height_m;          /* above the WGS 84 ellipsoid */
  double covariance_n[9];   /* of the position in n, m^2 */
  double velocity_n[3];     /* m/s */
  uint32_t satellites;      /* used in the solution, 0 unknown */
  uint32_t reserved;        /* 0 */
  double lever_b[3];        /* position of the antenna in b, m */
} odo_gnss;

/* One plane of a picture. Frozen at 24 bytes. */
typedef struct odo_plane {
  ODO_POINTER(const uint8_t *, data); /* first pixel of the first row; null where only loan.native has the pixels */
  int64_t row_stride;                 /* bytes from one row to the next */
  uint32_t pixel_stride;              /* bytes from one pixel (or chroma pair) to the next */
  uint32_t rows;                      /* of this plane; 0: as the format has it */
} odo_plane;

/* Luma and colour are used as they are, in full or in video range. */
#define ODO_FORMAT_GREY8 1u
#define ODO_FORMAT_NV12 2u  /* plane 0 luma, plane 1 interleaved U V, both at half size */
#define ODO_FORMAT_NV21 3u  /* plane 0 luma, plane 1 interleaved V U, both at half size */
#define ODO_FORMAT_RGB8 4u
#define ODO_FORMAT_RGBA8 5u
#define ODO_FORMAT_YUV420 6u /* planes 0 luma, 1 U, 2 V, both at half size; any pixel stride (Android's YUV_420_888) */
#define ODO_FORMAT_BGRA8 7u

/* A borrowed camera frame of the camera `header.source`. */
#define ODO_FRAME_EXPOSURE 1u
#define ODO_FRAME_LINE_TIME 2u
#define ODO_FRAME_MASK 4u
#define ODO_FRAME_INTRINSICS 8u /* fx, fy, cx, cy of this frame replace its calibration's (autofocus) */
typedef struct odo_frame {
  odo_header header;
  odo_loan loan;
  uint32_t format;      /* ODO_FORMAT_*; a number that a host does not know is passed on, and copied by its planes where the
                         * frame cannot be retained: then each of their rows has |row_stride| bytes, the last one too */
  uint32_t width;       /* pixels, 1 to 16384 */
  uint32_t height;      /* and no more than 2^24 in all */
  uint32_t plane_count; /* 1 to 4; 0: as the format has it */
  odo_plane planes[4];
  odo_plane mask;       /* grey8 of the frame's size, 0 = do not use this pixel */
  int64_t exposure_ns;  /* duration */
  int64_t line_time_ns; /* rolling shutter: from one row's exposure to the next's; 0 = global shutter */
  double fx;            /* pixels; valid with ODO_FRAME_INTRINSICS */
  double fy;
  double cx;            /* of the pixel centre, as in odo_calibration */
  double cy;
} odo_frame;

/* Calibration of the camera `header.source`; sent before the first frame of that camera, and again whenever it changes. */
#define ODO_CAMERA_PINHOLE 1u        /* radial-tangential; distortion k1 k2 p1 p2 [k3 [k4 k5 k6]] as in OpenCV */
#define ODO_CAMERA_KANNALA_BRANDT 2u /* fisheye; distortion k1 k2 k3 k4 (Kannala & Brandt 2006, as in OpenCV) */
#define ODO_CALIBRATION_EXTRINSICS 1u
#define ODO_CALIBRATION_TIME_OFFSET 2u
#define ODO_CALIBRATION_LINE_TIME 4u
typedef struct odo_calibration {
  odo_header header;
  uint32_t model;            /* ODO_CAMERA_* */
  uint32_t width;
  uint32_t height;
  uint32_t distortion_count; /* 0, 4, 5 or 8 */
  double fx, fy, cx, cy;     /* pixels; the centre of the first pixel is (0, 0) */
  double distortion[8];
  double q_b_c[4];           /* camera to body */
  double p_b_c[3];           /* camera's position in b, m */
  int64_t time_offset_ns;    /* IMU time = camera time + time_offset_ns. The host shifts the frames: plugins are given frames
                              * on the IMU's clock, and calibrations without ODO_CALIBRATION_TIME_OFFSET */
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
#define ODO_WAYPOINT_VERTICAL 1u /* p_n[2] is valid too */
#define ODO_WAYPOINT_LEVER 2u    /* without it p_n is the position of b's origin */
typedef struct odo_waypoint {
  odo_header header;
  double p_n[3];     /* m */
  double sigma_m;    /* standard deviation in each axis; always valid */
  double lever_b[3]; /* the point in b that is at p_n, m */
} odo_waypoint;

/* The Earth's magnetic field at the place of the session, from a model of it (World Magnetic Model: Android's
 * GeomagneticField, iOS' trueHeading minus magneticHeading). The host turns magnetic north into true north by it. */
#define ODO_EARTH_FIELD_DECLINATION 1u
#define ODO_EARTH_FIELD_INCLINATION 2u
#define ODO_EARTH_FIELD_INTENSITY 4u
typedef struct odo_earth_field {
  odo_header header;
  double declination_rad; /* magnetic north from true north, positive to the east */
  double inclination_rad; /* of the field below the horizontal */
  double intensity_t;     /* tesla */
} odo_earth_field;

/* A pose by the platform's own tracking (ARKit, ARCore, OpenXR), in its world w: metric, z downwards. Where w's y axis is up
 * (ARKit, ARCore: x right, z backwards) the app sets p_w = (-z, x, -y) and q_w likewise; docs/embed.md has it. */
#define ODO_PLATFORM_POSE_CAMERA 1u     /* of camera header.source; without it of the body */
#define ODO_PLATFORM_POSE_COVARIANCE 2u
typedef struct odo_platform_pose {
  odo_header header;
  double q_w[4];         /* camera (or body) to w */
  double p_w[3];         /* m */
  double covariance[36]; /* of (rotation in w, position in w), rad^2 and m^2 */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t world;        /* number of w: a new one where poses are not comparable with those before */
} odo_platform_pose;

/* A distance to a transmitter (ultra-wideband, Wi-Fi round-trip time). */
#define ODO_RANGE_TRANSMITTER 1u /* p_n and transmitter_sigma_m are valid */
#define ODO_RANGE_LEVER 2u       /* without it the antenna is at b's origin */
typedef struct odo_range {
  odo_header header;
  uint64_t transmitter;       /* its number, the app's choice */
  double range_m;
  double sigma_m;             /* standard deviation of range_m; always valid */
  double p_n[3];              /* position of the transmitter in n, m */
  double transmitter_sigma_m; /* standard deviation of it in each axis */
  double lever_b[3];          /* position of the antenna in b, m */
} odo_range;

/* The platform's own step sensor (Android's step counter and detector, CMPedometer). */
#define ODO_SYSTEM_STEP_COUNT 1u    /* count is valid; without it this is one detected step */
#define ODO_SYSTEM_STEP_DISTANCE 2u
typedef struct odo_system_step {
  odo_header header;
  uint64_t count;      /* steps since any start */
  double distance_m;   /* since the same start */
} odo_system_step;

#ifdef __cplusplus
}
#endif
#endif
