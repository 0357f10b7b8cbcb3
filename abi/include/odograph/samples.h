/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: what goes in, the samples of the sensors and what describes them. base.h has the rules.
 */
#ifndef ODOGRAPH_SAMPLES_H
#define ODOGRAPH_SAMPLES_H

#include <odograph/base.h>

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif
#endif
