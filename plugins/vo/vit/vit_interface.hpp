// SPDX-License-Identifier: Apache-2.0
//
// The part of Monado's Visual-Inertial Tracking interface (vit_interface.h, versions 1 and 2, which agree in it) that a
// consumer with one camera and one IMU needs. Names and layouts are the interface's.
#pragma once

#include <cstdint>

extern "C" {

struct vit_tracker;
struct vit_pose;

enum vit_result : int32_t { VIT_SUCCESS = 0, VIT_ERROR_NOT_SUPPORTED = -4 };  // negative: an error
enum vit_image_format : int32_t { VIT_IMAGE_FORMAT_L8 = 1 };
enum vit_camera_distortion : int32_t {
  VIT_CAMERA_DISTORTION_NONE,
  VIT_CAMERA_DISTORTION_RT4,
  VIT_CAMERA_DISTORTION_RT5,
  VIT_CAMERA_DISTORTION_RT8,
  VIT_CAMERA_DISTORTION_KB4
};

struct vit_config {
  const char* file;  // of the system's own kind, or null
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

struct vit_camera_calibration {
  uint32_t camera_index;
  int width, height;
  double frequency, fx, fy, cx, cy;
  vit_camera_distortion model;
  uint32_t distortion_count;
  double distortion[32];
  double transform[16];  // T_imu_cam, by rows
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
