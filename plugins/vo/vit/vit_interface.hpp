// SPDX-FileCopyrightText: 2023-2024 Collabora, Ltd.
// SPDX-FileCopyrightText: 2026 Odograph contributors
// SPDX-License-Identifier: Apache-2.0 AND BSL-1.0
//
// Declarations of Monado's Visual-Inertial Tracking interface (vit_interface.h 2.0, BSL-1.0), with its names and
// layouts. The part for a consumer with one camera and one IMU is the same in version 1.
#pragma once

#include <cstdint>

extern "C" {

struct vit_tracker;
struct vit_pose;

enum vit_result : int32_t {  // negative: an error
  VIT_SUCCESS = 0,
  VIT_ERROR_INVALID_VALUE = -2,
  VIT_ERROR_ALLOCATION_FAILURE = -3,
  VIT_ERROR_NOT_SUPPORTED = -4,
  VIT_ERROR_NOT_ENABLED = -5
};
enum vit_image_format : int32_t { VIT_IMAGE_FORMAT_L8 = 1, VIT_IMAGE_FORMAT_L16 = 2, VIT_IMAGE_FORMAT_R8G8B8 = 3 };
enum vit_camera_distortion : int32_t {
  VIT_CAMERA_DISTORTION_NONE,
  VIT_CAMERA_DISTORTION_RT4,
  VIT_CAMERA_DISTORTION_RT5,
  VIT_CAMERA_DISTORTION_RT8,
  VIT_CAMERA_DISTORTION_KB4
};

enum vit_tracker_extension : int32_t {
  VIT_TRACKER_EXTENSION_ADD_CAMERA_CALIBRATION,
  VIT_TRACKER_EXTENSION_ADD_IMU_CALIBRATION,
  VIT_TRACKER_EXTENSION_POSE_TIMING,
  VIT_TRACKER_EXTENSION_POSE_FEATURES
};

struct vit_tracker_extension_set {
  bool has_add_camera_calibration, has_add_imu_calibration, has_pose_timing, has_pose_features;
};

struct vit_tracker_timing_titles {
  uint32_t count;
  const char** titles;
};

struct vit_config {
  const char* file;  // of the system's format, or null
  uint32_t cam_count, imu_count;
  bool show_ui;
};

struct vit_imu_sample {
  int64_t timestamp;  // ns
  float ax, ay, az;   // m/s^2
  float wx, wy, wz;   // rad/s
};

struct vit_mask {
  float x, y, w, h;
};

struct vit_img_sample {
  uint32_t cam_index;
  int64_t timestamp;
  uint8_t* data;
  uint32_t width, height, stride, size;
  vit_image_format format;
  uint32_t mask_count;
  vit_mask* masks;
};

struct vit_pose_data {
  int64_t timestamp;
  float px, py, pz;      // of the IMU, m
  float ox, oy, oz, ow;  // quaternion
  float vx, vy, vz;
};

struct vit_pose_timing {
  uint32_t count;
  const int64_t* timestamps;
};

struct vit_pose_feature {
  int64_t id;
  float u, v, depth;
};

struct vit_pose_features {
  uint32_t count;
  const vit_pose_feature* features;
};

struct vit_camera_calibration {
  uint32_t camera_index;
  int width, height;
  double frequency, fx, fy, cx, cy;
  vit_camera_distortion model;
  uint32_t distortion_count;
  double distortion[32];
  double transform[16];  // T_imu_cam, by rows
};

struct vit_inertial_calibration {
  double transform[9];  // of the raw measurement, row-major
  double offset[3];     // added to it
  double bias_std[3];   // rad/s^2/sqrt(Hz), or m/s^3/sqrt(Hz)
  double noise_std[3];  // rad/s/sqrt(Hz), or m/s^2/sqrt(Hz)
};

struct vit_imu_calibration {
  uint32_t imu_index;
  double frequency;
  vit_inertial_calibration accel, gyro;
};

using vit_api_get_version_t = vit_result(uint32_t* major, uint32_t* minor, uint32_t* patch);
using vit_tracker_create_t = vit_result(const vit_config*, vit_tracker**);
using vit_tracker_destroy_t = void(vit_tracker*);
using vit_tracker_start_t = vit_result(vit_tracker*);
using vit_tracker_stop_t = vit_result(vit_tracker*);
using vit_tracker_push_imu_sample_t = vit_result(vit_tracker*, const vit_imu_sample*);
using vit_tracker_push_img_sample_t = vit_result(vit_tracker*, const vit_img_sample*);
using vit_tracker_add_camera_calibration_t = vit_result(vit_tracker*, const vit_camera_calibration*);
using vit_tracker_pop_pose_t = vit_result(vit_tracker*, vit_pose**);
using vit_pose_destroy_t = void(vit_pose*);
using vit_pose_get_data_t = vit_result(const vit_pose*, vit_pose_data*);
}
