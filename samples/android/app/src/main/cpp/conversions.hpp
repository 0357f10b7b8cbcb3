/* SPDX-License-Identifier: Apache-2.0
 *
 * Android's numbers as Odograph's: docs/phones.md is this file as a table. Nothing of Android is included, so that it
 * is compiled and tested on any machine.
 */
#ifndef PHONE_CONVERSIONS_HPP
#define PHONE_CONVERSIONS_HPP

#include <cmath>
#include <cstdint>
#include <cstring>

#include <odograph/samples.h>

namespace phone {

template <class Message>
Message message(uint32_t type, int64_t t_ns, uint32_t flags) {
  Message made;
  std::memset(&made, 0, sizeof made);
  made.header.struct_size = sizeof made;
  made.header.type = type;
  made.header.t_ns = t_ns;
  made.header.flags = flags;
  return made;
}

/// Fields of CameraCharacteristics. A false `has_`: this phone lacks the key.
struct CameraFacts {
  double array_width = 0, array_height = 0;  ///< SENSOR_INFO_PRE_CORRECTION_ACTIVE_ARRAY_SIZE, pixels
  int orientation_deg = 90;                  ///< SENSOR_ORIENTATION
  bool has_intrinsics = false, has_distortion = false, has_rotation = false, has_translation = false;
  float intrinsics[5] = {};                 ///< LENS_INTRINSIC_CALIBRATION: fx, fy, cx, cy, skew, of the array
  float distortion[5] = {};                 ///< LENS_DISTORTION: k1, k2, k3, p1, p2
  float rotation[4] = {};                   ///< LENS_POSE_ROTATION: x, y, z, w, from the sensors' axes to the camera's
  float translation[3] = {};                ///< LENS_POSE_TRANSLATION, m; only if LENS_POSE_REFERENCE is GYROSCOPE
  float focal_mm = 0, sensor_width_mm = 0;  ///< LENS_INFO_AVAILABLE_FOCAL_LENGTHS, SENSOR_INFO_PHYSICAL_SIZE
};

/// Crop of the array for a picture: the largest centred rectangle of its aspect ratio, then scaled.
struct Crop {
  double scale, left, top, height;
};

inline Crop crop_of(const CameraFacts& camera, int width, int height) {
  const double across = width / camera.array_width, down = height / camera.array_height;
  const double scale = across > down ? across : down;
  return {scale, (camera.array_width - width / scale) / 2, (camera.array_height - height / scale) / 2, height / scale};
}

/// Intrinsics of the array as those of the picture. Android counts from the corner of the first pixel, Odograph from
/// its centre.
inline void scale_intrinsics(const float* array, const Crop& crop, double* fx, double* fy, double* cx, double* cy) {
  *fx = array[0] * crop.scale;
  *fy = array[1] * crop.scale;
  *cx = (array[2] - crop.left) * crop.scale - 0.5;
  *cy = (array[3] - crop.top) * crop.scale - 0.5;
}

/// Middle of the exposure of the middle row, from the start of the first row's exposure.
inline int64_t middle_of_frame(int64_t start_ns, int64_t exposure_ns, int64_t skew_ns) {
  return start_ns + (exposure_ns + skew_ns) / 2;
}

/// Time from one row of the picture to the next, from SENSOR_ROLLING_SHUTTER_SKEW, which covers all rows of the array.
inline int64_t line_time(int64_t skew_ns, const CameraFacts& camera, const Crop& crop, int height) {
  return std::llround(static_cast<double>(skew_ns) * crop.height / camera.array_height / height);
}

/// Rotation from camera to body for a back camera with its picture in sensor orientation.
inline void mount_by_orientation(int orientation_deg, double* q_b_c) {
  const double half = orientation_deg * 3.14159265358979323846 / 360;
  q_b_c[0] = q_b_c[3] = 0;
  q_b_c[1] = std::cos(half);
  q_b_c[2] = -std::sin(half);
}

/// Uses the phone's own mount if it is within 10 degrees of SENSOR_ORIENTATION: some phones use other axes in it.
inline void set_mount(const CameraFacts& camera, double* q_b_c) {
  mount_by_orientation(camera.orientation_deg, q_b_c);
  if (!camera.has_rotation) return;
  const float* r = camera.rotation;
  const double q[4] = {r[3], -r[0], -r[1], -r[2]};
  double dot = 0, length = 0;
  for (int i = 0; i < 4; ++i) dot += q[i] * q_b_c[i], length += q[i] * q[i];
  const double at_most = std::cos(5.0 * 3.14159265358979323846 / 180);  // half the angle
  if (!(length > 0.9 && length < 1.1) || std::abs(dot) < at_most * std::sqrt(length)) return;
  for (int i = 0; i < 4; ++i) q_b_c[i] = q[i] / std::sqrt(length);
}

inline odo_calibration calibration_of(const CameraFacts& camera, int64_t t_ns, int width, int height) {
  auto made = message<odo_calibration>(ODO_TYPE_CALIBRATION, t_ns, ODO_CALIBRATION_EXTRINSICS);
  made.model = ODO_CAMERA_PINHOLE;
  made.width = static_cast<uint32_t>(width);
  made.height = static_cast<uint32_t>(height);
  const Crop crop = crop_of(camera, width, height);
  if (camera.has_intrinsics) {
    scale_intrinsics(camera.intrinsics, crop, &made.fx, &made.fy, &made.cx, &made.cy);
  } else {  // some percent off; the front-end refines it
    const bool known = camera.focal_mm > 0 && camera.sensor_width_mm > 0;
    made.fx = made.fy =
        known ? camera.focal_mm / camera.sensor_width_mm * camera.array_width * crop.scale : 0.79 * width;
    made.cx = (width - 1) / 2.0;
    made.cy = (height - 1) / 2.0;
  }
  if (camera.has_distortion) {
    const float* d = camera.distortion;
    const double ordered[5] = {d[0], d[1], d[3], d[4], d[2]};
    std::memcpy(made.distortion, ordered, sizeof ordered);
    made.distortion_count = 5;
  }
  set_mount(camera, made.q_b_c);
  if (camera.has_translation)
    for (int i = 0; i < 3; ++i) made.p_b_c[i] = camera.translation[i];
  return made;
}

inline odo_imu gyroscope(int64_t t_ns, const float* rad_per_s, bool corrected) {
  auto made = message<odo_imu>(ODO_TYPE_IMU, t_ns, ODO_IMU_GYRO | (corrected ? ODO_IMU_GYRO_CORRECTED : 0));
  for (int i = 0; i < 3; ++i) made.gyro_b[i] = rad_per_s[i];
  return made;
}

inline odo_imu accelerometer(int64_t t_ns, const float* m_per_s2, bool corrected) {
  auto made = message<odo_imu>(ODO_TYPE_IMU, t_ns, ODO_IMU_ACCEL | (corrected ? ODO_IMU_ACCEL_CORRECTED : 0));
  for (int i = 0; i < 3; ++i) made.accel_b[i] = m_per_s2[i];
  return made;
}

inline odo_magnetometer magnetometer(int64_t t_ns, const float* microtesla) {
  auto made = message<odo_magnetometer>(ODO_TYPE_MAGNETOMETER, t_ns, 0);
  for (int i = 0; i < 3; ++i) made.field_b[i] = 1e-6 * microtesla[i];
  return made;
}

inline odo_barometer barometer(int64_t t_ns, float hectopascal) {
  auto made = message<odo_barometer>(ODO_TYPE_BAROMETER, t_ns, 0);
  made.pressure_pa = 100.0 * hectopascal;
  return made;
}

/// android.location.Location: degrees, m above WGS 84, 68 % radius, one sigma of the height (0: not given).
inline odo_gnss gnss(int64_t elapsed_realtime_ns, double latitude, double longitude, double altitude, float accuracy,
                     float vertical_accuracy) {
  const double rad = 3.14159265358979323846 / 180, radius_of_68 = 1.51;  // in sigmas of one axis
  auto made = message<odo_gnss>(ODO_TYPE_GNSS, elapsed_realtime_ns, ODO_GNSS_POSITION);
  made.latitude_rad = latitude * rad;
  made.longitude_rad = longitude * rad;
  made.height_m = altitude;
  if (accuracy > 0) {
    const double sigma = accuracy / radius_of_68;
    made.header.flags |= ODO_GNSS_COVARIANCE;
    made.covariance_n[0] = made.covariance_n[4] = sigma * sigma;
    made.covariance_n[8] = vertical_accuracy > 0 ? double(vertical_accuracy) * vertical_accuracy : 1e4;
    if (vertical_accuracy > 0) made.header.flags |= ODO_GNSS_HEIGHT;
  }
  return made;
}

}  // namespace phone

#endif
