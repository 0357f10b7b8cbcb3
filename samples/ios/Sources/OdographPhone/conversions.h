/* SPDX-License-Identifier: Apache-2.0
 *
 * Conversions from an iPhone's sensors to Odograph: docs/phones.md has this file as a table. It includes no Apple
 * header, so that any machine can compile and test it.
 */
#ifndef PHONE_CONVERSIONS_H
#define PHONE_CONVERSIONS_H

#include <string.h>

#include <odograph/samples.h>

#define PHONE_STANDARD_GRAVITY 9.80665
#define PHONE_DEGREE (3.14159265358979323846 / 180)

static inline int64_t phone_ns(double seconds) { return (int64_t)(seconds * 1e9); }

static inline void phone_begin(odo_header* header, uint32_t size, uint32_t type, int64_t t_ns, uint32_t flags) {
  memset(header, 0, size);
  header->struct_size = size;
  header->type = type;
  header->t_ns = t_ns;
  header->flags = flags;
}

/* CMAccelerometerData: in g, pointing down at rest. */
static inline void phone_accelerometer(odo_imu* imu, double boot_s, double x, double y, double z) {
  phone_begin(&imu->header, sizeof *imu, ODO_TYPE_IMU, phone_ns(boot_s), ODO_IMU_ACCEL);
  imu->accel_b[0] = -PHONE_STANDARD_GRAVITY * x;
  imu->accel_b[1] = -PHONE_STANDARD_GRAVITY * y;
  imu->accel_b[2] = -PHONE_STANDARD_GRAVITY * z;
}

/* CMGyroData: rad/s, raw. */
static inline void phone_gyroscope(odo_imu* imu, double boot_s, double x, double y, double z) {
  phone_begin(&imu->header, sizeof *imu, ODO_TYPE_IMU, phone_ns(boot_s), ODO_IMU_GYRO);
  imu->gyro_b[0] = x, imu->gyro_b[1] = y, imu->gyro_b[2] = z;
}

/* CMAltitudeData: kPa. */
static inline void phone_barometer(odo_barometer* barometer, double boot_s, double kilopascal) {
  phone_begin(&barometer->header, sizeof *barometer, ODO_TYPE_BAROMETER, phone_ns(boot_s), 0);
  barometer->pressure_pa = 1000 * kilopascal;
}

/* CLLocation: degrees, ellipsoidalAltitude, both accuracies (0 or less: invalid). `age_s`: now minus its timestamp. */
static inline int phone_gnss(odo_gnss* gnss, double now_boot_s, double age_s, double latitude, double longitude,
                             double ellipsoidal_altitude, double horizontal_accuracy, double vertical_accuracy) {
  const double sigma = horizontal_accuracy / 1.51; /* assumed to be the 68 % radius; Apple does not specify it */
  if (horizontal_accuracy <= 0) return 0;
  phone_begin(&gnss->header, sizeof *gnss, ODO_TYPE_GNSS, phone_ns(now_boot_s - age_s),
              ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE);
  gnss->latitude_rad = latitude * PHONE_DEGREE;
  gnss->longitude_rad = longitude * PHONE_DEGREE;
  gnss->covariance_n[0] = gnss->covariance_n[4] = sigma * sigma;
  gnss->covariance_n[8] = vertical_accuracy > 0 ? vertical_accuracy * vertical_accuracy : 1e4;
  if (vertical_accuracy > 0) gnss->header.flags |= ODO_GNSS_HEIGHT, gnss->height_m = ellipsoidal_altitude;
  return 1;
}

/* The intrinsic matrix of a sample buffer: 3 columns of 4 floats in memory (matrix_float3x3), pixels of the picture. */
static inline void phone_intrinsics(odo_frame* frame, const float* columns) {
  frame->fx = columns[0];
  frame->fy = columns[5];
  frame->cx = columns[8] - 0.5; /* from the picture's corner to the centre of the first pixel */
  frame->cy = columns[9] - 0.5;
  frame->header.flags |= ODO_FRAME_INTRINSICS;
}

/* The back camera, its picture in sensor orientation. Without intrinsics the frame's are a guess, some percent off. */
static inline void phone_calibration(odo_calibration* calibration, const odo_frame* frame, double readout_s) {
  const int known = (frame->header.flags & ODO_FRAME_INTRINSICS) != 0;
  phone_begin(&calibration->header, sizeof *calibration, ODO_TYPE_CALIBRATION, frame->header.t_ns,
              ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_LINE_TIME);
  calibration->model = ODO_CAMERA_PINHOLE;
  calibration->width = frame->width;
  calibration->height = frame->height;
  calibration->fx = known ? frame->fx : 0.83 * frame->width;
  calibration->fy = known ? frame->fy : 0.83 * frame->width;
  calibration->cx = known ? frame->cx : (frame->width - 1) / 2.0;
  calibration->cy = known ? frame->cy : (frame->height - 1) / 2.0;
  calibration->q_b_c[1] = 0.70710678118654752, calibration->q_b_c[2] = -0.70710678118654752;
  calibration->line_time_ns = phone_ns(readout_s / frame->height);
}

#endif
