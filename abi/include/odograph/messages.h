/* SPDX-License-Identifier: Apache-2.0
 *
 * Written by abi/layout.py; do not edit. All messages as one list, and how large version 1.0 of each
 * struct was: a reader accepts what is at least as large, and takes fields behind its end for absent.
 */
#ifndef ODOGRAPH_MESSAGES_H
#define ODOGRAPH_MESSAGES_H

#include <odograph/types.h>

/* clang-format off */
/* X(type number, struct, name in files, size of 1.0) */
#define ODO_FOR_EACH_MESSAGE(X) \
  X(ODO_TYPE_IMU, odo_imu, imu, ODO_IMU_SIZE_MIN)                                      \
  X(ODO_TYPE_MAGNETOMETER, odo_magnetometer, magnetometer, ODO_MAGNETOMETER_SIZE_MIN)  \
  X(ODO_TYPE_BAROMETER, odo_barometer, barometer, ODO_BAROMETER_SIZE_MIN)              \
  X(ODO_TYPE_GNSS, odo_gnss, gnss, ODO_GNSS_SIZE_MIN)                                  \
  X(ODO_TYPE_FRAME, odo_frame, frame, ODO_FRAME_SIZE_MIN)                              \
  X(ODO_TYPE_CALIBRATION, odo_calibration, calibration, ODO_CALIBRATION_SIZE_MIN)      \
  X(ODO_TYPE_IMU_NOISE, odo_imu_noise, imu_noise, ODO_IMU_NOISE_SIZE_MIN)              \
  X(ODO_TYPE_WAYPOINT, odo_waypoint, waypoint, ODO_WAYPOINT_SIZE_MIN)                  \
  X(ODO_TYPE_ATTITUDE, odo_attitude, attitude, ODO_ATTITUDE_SIZE_MIN)                  \
  X(ODO_TYPE_STEP, odo_step, step, ODO_STEP_SIZE_MIN)                                  \
  X(ODO_TYPE_MOTION_MODE, odo_motion_mode, motion_mode, ODO_MOTION_MODE_SIZE_MIN)      \
  X(ODO_TYPE_VO_MOTION, odo_vo_motion, vo_motion, ODO_VO_MOTION_SIZE_MIN)              \
  X(ODO_TYPE_SCALE, odo_scale, scale, ODO_SCALE_SIZE_MIN)                              \
  X(ODO_TYPE_FIX, odo_fix, fix, ODO_FIX_SIZE_MIN)                                      \
  X(ODO_TYPE_POSE, odo_pose, pose, ODO_POSE_SIZE_MIN)                                  \
  X(ODO_TYPE_STATE, odo_state, state, ODO_STATE_SIZE_MIN)                              \
  X(ODO_TYPE_CORRECTION, odo_correction, correction, ODO_CORRECTION_SIZE_MIN)          \
  X(ODO_TYPE_REPORT, odo_report, report, ODO_REPORT_SIZE_MIN)

#define ODO_IMU_SIZE_MIN UINT32_C(80)
#define ODO_MAGNETOMETER_SIZE_MIN UINT32_C(56)
#define ODO_BAROMETER_SIZE_MIN UINT32_C(40)
#define ODO_GNSS_SIZE_MIN UINT32_C(160)
#define ODO_FRAME_SIZE_MIN UINT32_C(208)
#define ODO_CALIBRATION_SIZE_MIN UINT32_C(224)
#define ODO_IMU_NOISE_SIZE_MIN UINT32_C(64)
#define ODO_WAYPOINT_SIZE_MIN UINT32_C(64)
#define ODO_ATTITUDE_SIZE_MIN UINT32_C(160)
#define ODO_STEP_SIZE_MIN UINT32_C(88)
#define ODO_MOTION_MODE_SIZE_MIN UINT32_C(40)
#define ODO_VO_MOTION_SIZE_MIN UINT32_C(544)
#define ODO_SCALE_SIZE_MIN UINT32_C(80)
#define ODO_FIX_SIZE_MIN UINT32_C(312)
#define ODO_POSE_SIZE_MIN UINT32_C(432)
#define ODO_STATE_SIZE_MIN UINT32_C(40)
#define ODO_CORRECTION_SIZE_MIN UINT32_C(96)
#define ODO_ERROR_SIZE_MIN UINT32_C(2048)
#define ODO_SESSION_OPTIONS_SIZE_MIN UINT32_C(40)
#define ODO_STATISTICS_SIZE_MIN UINT32_C(8)
#define ODO_HOST_SIZE_MIN UINT32_C(40)
#define ODO_REPORT_SERVICE_SIZE_MIN UINT32_C(16)
#define ODO_RANDOM_SERVICE_SIZE_MIN UINT32_C(16)
#define ODO_ASSET_SERVICE_SIZE_MIN UINT32_C(16)
#define ODO_PARAMETER_SIZE_MIN UINT32_C(112)
#define ODO_VALUE_SIZE_MIN UINT32_C(64)
#define ODO_BATCH_SIZE_MIN UINT32_C(16)
#define ODO_SINK_SIZE_MIN UINT32_C(16)
#define ODO_PLUGIN_SIZE_MIN UINT32_C(144)
#define ODO_REPORT_SIZE_MIN UINT32_C(1200)
#define ODO_ANCHOR_PLACE_SIZE_MIN UINT32_C(136)
#define ODO_ANCHOR_SIZE_MIN UINT32_C(264)
#define ODO_TERRAIN_SIZE_MIN UINT32_C(24)
#define ODO_SKYLINE_DATABASE_SIZE_MIN UINT32_C(56)
#define ODO_SKYLINES_SIZE_MIN UINT32_C(48)
/* clang-format on */

#endif
