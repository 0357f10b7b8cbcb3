/* SPDX-License-Identifier: Apache-2.0
 *
 * Written by abi/generate.py; do not edit. List of all messages, and the size of version 1.0 of each
 * struct. A reader accepts a struct of at least this size, and treats fields beyond its end as absent.
 */
#ifndef ODOGRAPH_MESSAGES_H
#define ODOGRAPH_MESSAGES_H

#include <odograph/types.h>

/* clang-format off */
/* X(type number, struct, name in files, size of 1.0) */
#define ODO_FOR_EACH_MESSAGE(X) \
  X(ODO_TYPE_IMU, odo_imu, imu, ODO_IMU_SIZE_MIN)                                          \
  X(ODO_TYPE_MAGNETOMETER, odo_magnetometer, magnetometer, ODO_MAGNETOMETER_SIZE_MIN)      \
  X(ODO_TYPE_BAROMETER, odo_barometer, barometer, ODO_BAROMETER_SIZE_MIN)                  \
  X(ODO_TYPE_GNSS, odo_gnss, gnss, ODO_GNSS_SIZE_MIN)                                      \
  X(ODO_TYPE_CALIBRATION, odo_calibration, calibration, ODO_CALIBRATION_SIZE_MIN)          \
  X(ODO_TYPE_IMU_NOISE, odo_imu_noise, imu_noise, ODO_IMU_NOISE_SIZE_MIN)                  \
  X(ODO_TYPE_WAYPOINT, odo_waypoint, waypoint, ODO_WAYPOINT_SIZE_MIN)                      \
  X(ODO_TYPE_EARTH_FIELD, odo_earth_field, earth_field, ODO_EARTH_FIELD_SIZE_MIN)          \
  X(ODO_TYPE_PLATFORM_POSE, odo_platform_pose, platform_pose, ODO_PLATFORM_POSE_SIZE_MIN)  \
  X(ODO_TYPE_RANGE, odo_range, range, ODO_RANGE_SIZE_MIN)                                  \
  X(ODO_TYPE_SYSTEM_STEP, odo_system_step, system_step, ODO_SYSTEM_STEP_SIZE_MIN)          \
  X(ODO_TYPE_FRAME, odo_frame, frame, ODO_FRAME_SIZE_MIN)                                  \
  X(ODO_TYPE_ATTITUDE, odo_attitude, attitude, ODO_ATTITUDE_SIZE_MIN)                      \
  X(ODO_TYPE_STEP, odo_step, step, ODO_STEP_SIZE_MIN)                                      \
  X(ODO_TYPE_MOTION_MODE, odo_motion_mode, motion_mode, ODO_MOTION_MODE_SIZE_MIN)          \
  X(ODO_TYPE_VO_MOTION, odo_vo_motion, vo_motion, ODO_VO_MOTION_SIZE_MIN)                  \
  X(ODO_TYPE_SCALE, odo_scale, scale, ODO_SCALE_SIZE_MIN)                                  \
  X(ODO_TYPE_FIX, odo_fix, fix, ODO_FIX_SIZE_MIN)                                          \
  X(ODO_TYPE_POSE, odo_pose, pose, ODO_POSE_SIZE_MIN)                                      \
  X(ODO_TYPE_STATE, odo_state, state, ODO_STATE_SIZE_MIN)                                  \
  X(ODO_TYPE_CORRECTION, odo_correction, correction, ODO_CORRECTION_SIZE_MIN)              \
  X(ODO_TYPE_REPORT, odo_report, report, ODO_REPORT_SIZE_MIN)                              \
  X(ODO_TYPE_REFINED, odo_refined, refined, ODO_REFINED_SIZE_MIN)                          \
  X(ODO_TYPE_RELATIVE_POSE, odo_relative_pose, relative_pose, ODO_RELATIVE_POSE_SIZE_MIN)  \
  X(ODO_TYPE_POINTS, odo_points, points, ODO_POINTS_SIZE_MIN)                              \
  X(ODO_TYPE_SURFACE, odo_surface, surface, ODO_SURFACE_SIZE_MIN)                          \
  X(ODO_TYPE_KEY_FRAME, odo_key_frame, key_frame, ODO_KEY_FRAME_SIZE_MIN)                  \
  X(ODO_TYPE_MAP_POSE, odo_map_pose, map_pose, ODO_MAP_POSE_SIZE_MIN)

#define ODO_ATTITUDE_SIZE_MIN 160u
#define ODO_STEP_SIZE_MIN 96u
#define ODO_MOTION_MODE_SIZE_MIN 40u
#define ODO_VO_MOTION_SIZE_MIN 544u
#define ODO_SCALE_SIZE_MIN 80u
#define ODO_FIX_SIZE_MIN 440u
#define ODO_RELATIVE_POSE_SIZE_MIN 384u
#define ODO_POSE_SIZE_MIN 544u
#define ODO_STATE_SIZE_MIN 40u
#define ODO_CORRECTION_SIZE_MIN 96u
#define ODO_REFINED_SIZE_MIN 224u
#define ODO_REPORT_SIZE_MIN 1200u
#define ODO_IMU_SIZE_MIN 80u
#define ODO_MAGNETOMETER_SIZE_MIN 64u
#define ODO_BAROMETER_SIZE_MIN 48u
#define ODO_GNSS_SIZE_MIN 184u
#define ODO_FRAME_SIZE_MIN 256u
#define ODO_CALIBRATION_SIZE_MIN 216u
#define ODO_IMU_NOISE_SIZE_MIN 64u
#define ODO_WAYPOINT_SIZE_MIN 88u
#define ODO_EARTH_FIELD_SIZE_MIN 56u
#define ODO_PLATFORM_POSE_SIZE_MIN 384u
#define ODO_RANGE_SIZE_MIN 112u
#define ODO_SYSTEM_STEP_SIZE_MIN 48u
#define ODO_HOST_SIZE_MIN 40u
#define ODO_REPORT_SERVICE_SIZE_MIN 16u
#define ODO_RANDOM_SERVICE_SIZE_MIN 16u
#define ODO_ASSET_SERVICE_SIZE_MIN 16u
#define ODO_ASSET_SERVICE_2_SIZE_MIN 40u
#define ODO_WAKE_SERVICE_SIZE_MIN 16u
#define ODO_PARAMETER_SIZE_MIN 112u
#define ODO_VALUE_SIZE_MIN 64u
#define ODO_BATCH_SIZE_MIN 16u
#define ODO_SINK_SIZE_MIN 16u
#define ODO_PLUGIN_SIZE_MIN 208u
#define ODO_ERROR_SIZE_MIN 2048u
#define ODO_SESSION_OPTIONS_SIZE_MIN 104u
#define ODO_STATISTICS_SIZE_MIN 184u
#define ODO_ANCHOR_PLACE_SIZE_MIN 136u
#define ODO_ANCHOR_SIZE_MIN 264u
#define ODO_TERRAIN_SIZE_MIN 24u
#define ODO_CONTENT_SERVICE_SIZE_MIN 40u
#define ODO_POINTS_SIZE_MIN 56u
#define ODO_POINT_SIZE_MIN 64u
#define ODO_SURFACE_SIZE_MIN 144u
#define ODO_VERTEX_SIZE_MIN 8u
#define ODO_MAP_POINT_SIZE_MIN 48u
#define ODO_RAY_SIZE_MIN 104u
#define ODO_HIT_SIZE_MIN 136u
#define ODO_KEY_FRAME_SIZE_MIN 48u
#define ODO_MAP_POSE_SIZE_MIN 400u
#define ODO_RUN_SERVICE_SIZE_MIN 8u
/* clang-format on */

#endif
