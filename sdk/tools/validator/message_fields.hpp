// SPDX-License-Identifier: Apache-2.0
//
// Every number of every message that comes from outside the host: its constraint and the flag with which it is valid.
#pragma once

#include <cstddef>
#include <cstdint>

#include <odograph/messages.h>

namespace odograph {

/// Constraint of a number; `natural`: 0 or more; `any`: the host's own, or never accepted from outside.
enum class Rule { finite, natural, positive, share, unit, direction, lat, lon, height, place, sensed, matrix, any };

struct MessageField {
  uint32_t type;
  const char* name;
  size_t offset, size;
  Rule rule;
  uint32_t flag;  ///< 0: always valid
  size_t count() const { return size / sizeof(double); }
};

/// The flags of a fix's position.
inline constexpr uint32_t kFixPosition = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_GEODETIC;

/// Flags without which a message is rejected that lacks this one.
inline uint32_t flags_that_need(uint32_t type, uint32_t flag) {
  if (type == ODO_TYPE_FIX && flag == ODO_FIX_COVARIANCE) return kFixPosition;
  return type == ODO_TYPE_FIX && flag == ODO_FIX_ORIENTATION_COVARIANCE ? ODO_FIX_ORIENTATION : 0;
}

#define ODO_FIELD(type, message, field, rule, flag) \
  { type, #field, offsetof(message, field), sizeof(message::field), Rule::rule, flag }

inline constexpr MessageField kMessageFields[] = {
    ODO_FIELD(ODO_TYPE_IMU, odo_imu, gyro_b, sensed, ODO_IMU_GYRO),
    ODO_FIELD(ODO_TYPE_IMU, odo_imu, accel_b, sensed, ODO_IMU_ACCEL),
    ODO_FIELD(ODO_TYPE_MAGNETOMETER, odo_magnetometer, field_b, sensed, 0),
    ODO_FIELD(ODO_TYPE_MAGNETOMETER, odo_magnetometer, sigma_t, natural, ODO_MAGNETOMETER_SIGMA),
    ODO_FIELD(ODO_TYPE_BAROMETER, odo_barometer, pressure_pa, sensed, 0),
    ODO_FIELD(ODO_TYPE_BAROMETER, odo_barometer, sigma_pa, natural, ODO_BAROMETER_SIGMA),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, latitude_rad, lat, ODO_GNSS_POSITION),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, longitude_rad, lon, ODO_GNSS_POSITION),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, height_m, height, ODO_GNSS_HEIGHT),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, covariance_n, matrix, ODO_GNSS_COVARIANCE),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, velocity_n, finite, ODO_GNSS_VELOCITY),
    ODO_FIELD(ODO_TYPE_GNSS, odo_gnss, lever_b, finite, ODO_GNSS_LEVER),
    ODO_FIELD(ODO_TYPE_FRAME, odo_frame, fx, positive, ODO_FRAME_INTRINSICS),
    ODO_FIELD(ODO_TYPE_FRAME, odo_frame, fy, positive, ODO_FRAME_INTRINSICS),
    ODO_FIELD(ODO_TYPE_FRAME, odo_frame, cx, finite, ODO_FRAME_INTRINSICS),
    ODO_FIELD(ODO_TYPE_FRAME, odo_frame, cy, finite, ODO_FRAME_INTRINSICS),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, fx, positive, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, fy, positive, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, cx, finite, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, cy, finite, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, distortion, finite, 0),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, q_b_c, unit, ODO_CALIBRATION_EXTRINSICS),
    ODO_FIELD(ODO_TYPE_CALIBRATION, odo_calibration, p_b_c, finite, ODO_CALIBRATION_EXTRINSICS),
    ODO_FIELD(ODO_TYPE_IMU_NOISE, odo_imu_noise, gyro_noise, natural, 0),
    ODO_FIELD(ODO_TYPE_IMU_NOISE, odo_imu_noise, gyro_walk, natural, 0),
    ODO_FIELD(ODO_TYPE_IMU_NOISE, odo_imu_noise, accel_noise, natural, 0),
    ODO_FIELD(ODO_TYPE_IMU_NOISE, odo_imu_noise, accel_walk, natural, 0),
    ODO_FIELD(ODO_TYPE_WAYPOINT, odo_waypoint, p_n, place, 0),
    ODO_FIELD(ODO_TYPE_WAYPOINT, odo_waypoint, sigma_m, natural, 0),
    ODO_FIELD(ODO_TYPE_WAYPOINT, odo_waypoint, lever_b, finite, ODO_WAYPOINT_LEVER),
    ODO_FIELD(ODO_TYPE_EARTH_FIELD, odo_earth_field, declination_rad, finite, ODO_EARTH_FIELD_DECLINATION),
    ODO_FIELD(ODO_TYPE_EARTH_FIELD, odo_earth_field, inclination_rad, finite, ODO_EARTH_FIELD_INCLINATION),
    ODO_FIELD(ODO_TYPE_EARTH_FIELD, odo_earth_field, intensity_t, positive, ODO_EARTH_FIELD_INTENSITY),
    ODO_FIELD(ODO_TYPE_PLATFORM_POSE, odo_platform_pose, q_w, unit, 0),
    ODO_FIELD(ODO_TYPE_PLATFORM_POSE, odo_platform_pose, p_w, finite, 0),
    ODO_FIELD(ODO_TYPE_PLATFORM_POSE, odo_platform_pose, covariance, matrix, ODO_PLATFORM_POSE_COVARIANCE),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, range_m, natural, 0),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, sigma_m, positive, 0),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, p_n, place, ODO_RANGE_TRANSMITTER),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, transmitter_sigma_m, natural, ODO_RANGE_TRANSMITTER),
    ODO_FIELD(ODO_TYPE_RANGE, odo_range, lever_b, finite, ODO_RANGE_LEVER),
    ODO_FIELD(ODO_TYPE_SYSTEM_STEP, odo_system_step, distance_m, natural, ODO_SYSTEM_STEP_DISTANCE),
    ODO_FIELD(ODO_TYPE_ATTITUDE, odo_attitude, q_n_b, unit, 0),
    ODO_FIELD(ODO_TYPE_ATTITUDE, odo_attitude, covariance_n, matrix, ODO_ATTITUDE_COVARIANCE),
    ODO_FIELD(ODO_TYPE_ATTITUDE, odo_attitude, gyro_bias_b, finite, ODO_ATTITUDE_GYRO_BIAS),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, length_m, natural, 0),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, sigma_m, natural, 0),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, frequency_hz, finite, 0),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, heading_rad, finite, ODO_STEP_HEADING),
    ODO_FIELD(ODO_TYPE_STEP, odo_step, heading_sigma_rad, positive, ODO_STEP_HEADING_SIGMA),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, q_c0_c1, unit, ODO_VO_ROTATION),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, p_c0_c1, finite, ODO_VO_TRANSLATION),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, covariance, matrix, ODO_VO_COVARIANCE),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, q_n_c0, any, ODO_FLAG_NAVIGATION),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, scale_sigma, natural, ODO_VO_METRIC | ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, velocity_c1, finite, ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, gravity_c1, direction, ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, gyro_bias_b, finite, ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_VO_MOTION, odo_vo_motion, accel_bias_b, finite, ODO_VO_INERTIAL),
    ODO_FIELD(ODO_TYPE_SCALE, odo_scale, scale, natural, 0),
    ODO_FIELD(ODO_TYPE_SCALE, odo_scale, sigma, natural, 0),
    ODO_FIELD(ODO_TYPE_SCALE, odo_scale, displacement_m, finite, 0),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, p_n, place, kFixPosition),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, covariance_n, matrix, ODO_FIX_COVARIANCE),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, q_n_b, unit, ODO_FIX_ORIENTATION),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, orientation_cov_n, matrix, ODO_FIX_ORIENTATION_COVARIANCE),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, yaw_rad, finite, ODO_FIX_YAW),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, yaw_sigma_rad, positive, ODO_FIX_YAW),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, latitude_rad, lat, ODO_FIX_GEODETIC),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, longitude_rad, lon, ODO_FIX_GEODETIC),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, height_m, height, ODO_FIX_GEODETIC),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, integrity, share, ODO_FIX_INTEGRITY),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, landmark_n, place, ODO_FIX_SLANT),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, slant_distance_m, natural, ODO_FIX_SLANT),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, lever_b, finite, ODO_FIX_LEVER),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, yaw_axis_b, direction, ODO_FIX_YAW),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, cross_covariance_n, finite, ODO_FIX_CROSS_COVARIANCE),
    ODO_FIELD(ODO_TYPE_FIX, odo_fix, slant_sigma_m, positive, ODO_FIX_SLANT_SIGMA),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, fx, positive, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, fy, positive, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, cx, finite, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, cy, finite, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, distortion, finite, 0),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, q_b_c, unit, ODO_REFINED_EXTRINSICS),
    ODO_FIELD(ODO_TYPE_REFINED, odo_refined, p_b_c, finite, ODO_REFINED_EXTRINSICS),
    ODO_FIELD(ODO_TYPE_RELATIVE_POSE, odo_relative_pose, q_b0_b1, unit, ODO_RELATIVE_POSE_ROTATION),
    ODO_FIELD(ODO_TYPE_RELATIVE_POSE, odo_relative_pose, p_b0_b1, finite, ODO_RELATIVE_POSE_TRANSLATION),
    ODO_FIELD(ODO_TYPE_RELATIVE_POSE, odo_relative_pose, covariance, matrix, 0),
    ODO_FIELD(ODO_TYPE_KEY_FRAME, odo_key_frame, q_n_b, any, ODO_FLAG_NAVIGATION),
    ODO_FIELD(ODO_TYPE_KEY_FRAME, odo_key_frame, p_n_b, any, ODO_FLAG_NAVIGATION),
    ODO_FIELD(ODO_TYPE_MAP_POSE, odo_map_pose, q_m_b, unit, 0),
    ODO_FIELD(ODO_TYPE_MAP_POSE, odo_map_pose, p_m_b, place, 0),
    ODO_FIELD(ODO_TYPE_MAP_POSE, odo_map_pose, covariance, matrix, 0),
    ODO_FIELD(ODO_TYPE_MAP_POSE, odo_map_pose, map_sigma_m, natural, 0),
    ODO_FIELD(ODO_TYPE_MAP_POSE, odo_map_pose, map_sigma_rad, natural, 0),
    ODO_FIELD(ODO_TYPE_SURFACE, odo_surface, q_n, unit, 0),
    ODO_FIELD(ODO_TYPE_SURFACE, odo_surface, p_n, place, 0),
    ODO_FIELD(ODO_TYPE_SURFACE, odo_surface, sigma_m, natural, 0),
    ODO_FIELD(ODO_TYPE_SURFACE, odo_surface, tilt_sigma_rad, natural, 0),
};
#undef ODO_FIELD

}  // namespace odograph
