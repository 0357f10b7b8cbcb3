/* SPDX-License-Identifier: Apache-2.0
 *
 * Odograph ABI, part 1: inputs, which are sensor samples and sensor descriptions. base.h has the conventions and rules.
 */
#ifndef ODOGRAPH_SAMPLES_H
#define ODOGRAPH_SAMPLES_H

#include <odograph/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* [any] Copies a message into a struct of `size` bytes. Use it instead of `*mine = *message`, which reads beyond the
 * end of an older, smaller message. Fields that the message lacks become zero, and ODO_HAS is false for them; fields
 * beyond `size` are omitted. */
static inline void odo_copy(void *mine, uint32_t size, const odo_header *message) {
  const uint32_t available = message->struct_size < size ? message->struct_size : size;
  const unsigned char *from = (const unsigned char *)(const void *)message;
  unsigned char *to = (unsigned char *)mine;
  uint32_t i;
  for (i = 0; i < size; ++i) to[i] = (unsigned char)(i < available ? from[i] : 0);
  *(uint32_t *)mine = available;
}

/* Inertial sample. If gyroscope and accelerometer are delivered separately, push a sample for each, with one bit set:
 * the host interpolates the accelerometer at the times of the gyroscope. Without the CORRECTED bits the values are raw
 * measurements (Android's *_UNCALIBRATED, raw Core Motion data). Of several gyroscopes, accelerometers, magnetometers
 * or barometers (header.source) the host takes the first that delivers, and refuses the others (ODO_E_UNSUPPORTED). */
#define ODO_IMU_GYRO 1u
#define ODO_IMU_ACCEL 2u
#define ODO_IMU_GYRO_CORRECTED 4u  /* the operating system has subtracted its bias estimate */
#define ODO_IMU_ACCEL_CORRECTED 8u
typedef struct odo_imu {
  odo_header header;
  double gyro_b[3];  /* rad/s */
  double accel_b[3]; /* specific force, m/s^2: at rest about 9.81, upwards */
} odo_imu;

#define ODO_MAGNETOMETER_SIGMA 1u
#define ODO_MAGNETOMETER_CORRECTED 2u /* the operating system has subtracted its hard-iron estimate */
typedef struct odo_magnetometer {
  odo_header header;
  double field_b[3]; /* magnetic flux density, tesla */
  double sigma_t;    /* standard deviation of each component, tesla; valid with ODO_MAGNETOMETER_SIGMA */
} odo_magnetometer;

#define ODO_BAROMETER_SIGMA 1u
typedef struct odo_barometer {
  odo_header header;
  double pressure_pa;
  double sigma_pa; /* standard deviation, Pa; valid with ODO_BAROMETER_SIGMA; not used by this library up to 1.0 */
} odo_barometer;

#define ODO_GNSS_POSITION 1u
#define ODO_GNSS_HEIGHT 2u
#define ODO_GNSS_COVARIANCE 4u
#define ODO_GNSS_VELOCITY 8u
#define ODO_GNSS_LEVER 16u /* if not set, the antenna is at the origin of b */
typedef struct odo_gnss {
  odo_header header;
  double latitude_rad;      /* geodetic, WGS 84 */
  double longitude_rad;     /* WGS 84 */
  double height_m;          /* above the WGS 84 ellipsoid */
  double covariance_n[9];   /* of the position, in North-East-Down there, m^2 */
  double velocity_n[3];     /* in North-East-Down there, m/s */
  uint32_t satellites;      /* number used in the solution; 0: unknown */
  uint32_t reserved;        /* 0 */
  double lever_b[3];        /* position of the antenna in b, m */
} odo_gnss;

/* One plane of an image. Frozen at 24 bytes. */
typedef struct odo_plane {
  ODO_POINTER(const uint8_t *, data); /* first pixel of the first row; null if only loan.native has the pixels */
  int64_t row_stride;                 /* bytes from one row to the next; negative: bottom row first in memory.
                                       * Bytes after the last pixel of a row need not be readable */
  uint32_t pixel_stride;              /* bytes from one chroma sample to the next in YUV420, 0: 1; unused otherwise */
  uint32_t rows;                      /* of this plane; 0: implied by the format */
} odo_plane;

/* Full and video range are both accepted; values are used without conversion. Half sizes are rounded up. */
#define ODO_FORMAT_GREY8 1u
#define ODO_FORMAT_NV12 2u  /* plane 0 luma, plane 1 interleaved U V, both at half size */
#define ODO_FORMAT_NV21 3u  /* plane 0 luma, plane 1 interleaved V U, both at half size */
#define ODO_FORMAT_RGB8 4u
#define ODO_FORMAT_RGBA8 5u
#define ODO_FORMAT_YUV420 6u /* plane 0 luma, 1 U, 2 V, both at half size; any pixel stride (Android's YUV_420_888) */
#define ODO_FORMAT_BGRA8 7u

/* A frame of the camera `header.source`, with borrowed pixels. */
#define ODO_FRAME_EXPOSURE 1u
#define ODO_FRAME_LINE_TIME 2u
#define ODO_FRAME_MASK 4u
#define ODO_FRAME_INTRINSICS 8u /* fx, fy, cx, cy replace those of the calibration for this frame (autofocus) */
typedef struct odo_frame {
  odo_header header;
  odo_loan loan;
  uint32_t format;      /* ODO_FORMAT_*. A format unknown to the host is forwarded; if the frame cannot be retained, its
                         * planes are copied, and then every row, including the last, must have |row_stride| readable
                         * bytes */
  uint32_t width;       /* pixels, 1 to 16384 */
  uint32_t height;      /* pixels, 1 to 16384; width * height is at most 2^24 */
  uint32_t plane_count; /* 1 to 4; 0: implied by the format */
  odo_plane planes[4];
  odo_plane mask;       /* grey8 with the size of the frame; pixels with value 0 are not used */
  int64_t exposure_ns;  /* duration of the exposure of a row */
  int64_t line_time_ns; /* rolling shutter: time between the exposures of consecutive rows, negative if the last row is
                         * exposed first; 0: global shutter. It replaces that of the calibration */
  double fx;            /* pixels; valid with ODO_FRAME_INTRINSICS */
  double fy;
  double cx;            /* pixels; the centre of the first pixel is (0, 0), as in odo_calibration */
  double cy;
} odo_frame;

/* Calibration of the camera `header.source`. Push it before the first frame of that camera and whenever it changes. The
 * host forwards a model that it does not know, with any number of coefficients: check the model before you use it. */
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
  uint32_t distortion_count; /* PINHOLE: 0, 4, 5 or 8; KANNALA_BRANDT: 0 or 4 */
  double fx, fy, cx, cy;     /* pixels; the centre of the first pixel is (0, 0) */
  double distortion[8];
  double q_b_c[4];           /* rotates vectors from camera to body */
  double p_b_c[3];           /* position of the camera in b, m */
  int64_t time_offset_ns;    /* IMU time = camera time + time_offset_ns. The host applies it: plugins receive frames in
                              * IMU time and calibrations without ODO_CALIBRATION_TIME_OFFSET */
  int64_t line_time_ns;      /* rolling shutter: time between the exposures of consecutive rows */
} odo_calibration;

/* IMU noise densities and random walks, for example from an Allan deviation. */
typedef struct odo_imu_noise {
  odo_header header;
  double gyro_noise;  /* rad/s/sqrt(Hz) */
  double gyro_walk;   /* bias random walk, rad/s^2/sqrt(Hz) */
  double accel_noise; /* m/s^2/sqrt(Hz) */
  double accel_walk;  /* bias random walk, m/s^3/sqrt(Hz) */
} odo_imu_noise;

/* A known position of the user at time t_ns: a tap on a map, a surveyed mark. */
#define ODO_WAYPOINT_VERTICAL 1u /* p_n[2] is valid too */
#define ODO_WAYPOINT_LEVER 2u    /* if not set, p_n is the position of the origin of b */
typedef struct odo_waypoint {
  odo_header header;
  double p_n[3];     /* m */
  double sigma_m;    /* standard deviation in each axis; always valid */
  double lever_b[3]; /* the point in b whose position is p_n, m */
} odo_waypoint;

/* The Earth's magnetic field at the location of the session, from a model such as the World Magnetic Model (Android's
 * GeomagneticField; iOS: trueHeading minus magneticHeading). The host uses the declination to convert magnetic to true
 * north; inclination and intensity are not used by this library up to 1.0. */
#define ODO_EARTH_FIELD_DECLINATION 1u
#define ODO_EARTH_FIELD_INCLINATION 2u
#define ODO_EARTH_FIELD_INTENSITY 4u
typedef struct odo_earth_field {
  odo_header header;
  double declination_rad; /* angle from true north to magnetic north, positive to the east */
  double inclination_rad; /* angle of the field below the horizontal */
  double intensity_t;     /* tesla */
} odo_earth_field;

/* A pose from the tracking of the platform (ARKit, ARCore, OpenXR) at a time of the IMU's clock, in its world frame w:
 * metric, z downwards. If the y
 * axis of the platform's world points up (ARKit, ARCore: x right, z backwards), the app sets p_w = (-z, x, -y) and
 * converts q_w likewise, see docs/embed.md. */
#define ODO_PLATFORM_POSE_CAMERA 1u     /* pose of the camera header.source; if not set, of the body */
#define ODO_PLATFORM_POSE_COVARIANCE 2u
typedef struct odo_platform_pose {
  odo_header header;
  double q_w[4];         /* rotates vectors from the camera (or body) to w */
  double p_w[3];         /* m */
  double covariance[36]; /* of (rotation in w, position in w), rad^2 and m^2 */
  uint32_t state;        /* ODO_TRACKING, ODO_DEGRADED, ODO_LOST */
  uint32_t world;        /* number of w; changes when poses are no longer comparable with earlier ones */
} odo_platform_pose;

/* A distance to a transmitter (ultra-wideband, Wi-Fi round-trip time). */
#define ODO_RANGE_TRANSMITTER 1u /* p_n and transmitter_sigma_m are valid */
#define ODO_RANGE_LEVER 2u       /* if not set, the antenna is at the origin of b */
typedef struct odo_range {
  odo_header header;
  uint64_t transmitter;       /* number of the transmitter, chosen by the app */
  double range_m;
  double sigma_m;             /* standard deviation of range_m; always valid */
  double p_n[3];              /* position of the transmitter in n, m */
  double transmitter_sigma_m; /* standard deviation of p_n in each axis */
  double lever_b[3];          /* position of the antenna in b, m */
} odo_range;

/* The step sensor of the platform (Android's step counter and detector, CMPedometer). Passed to plugins that declare it;
 * not used by this library up to 1.0 or its plugins. */
#define ODO_SYSTEM_STEP_COUNT 1u    /* count is valid; if not set, the message is one detected step */
#define ODO_SYSTEM_STEP_DISTANCE 2u
typedef struct odo_system_step {
  odo_header header;
  uint64_t count;      /* steps since an arbitrary start */
  double distance_m;   /* distance since the same start */
} odo_system_step;

#ifdef __cplusplus
}
#endif
#endif
