/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <stdint.h>
extern "C" {
typedef enum { ACAMERA_OK = 0 } camera_status_t;
typedef enum acamera_metadata_tag : uint32_t {
  ACAMERA_CONTROL_AE_TARGET_FPS_RANGE,
  ACAMERA_CONTROL_AF_MODE,
  ACAMERA_CONTROL_VIDEO_STABILIZATION_MODE,
  ACAMERA_DISTORTION_CORRECTION_MODE,
  ACAMERA_LENS_DISTORTION,
  ACAMERA_LENS_FACING,
  ACAMERA_LENS_FOCUS_DISTANCE,
  ACAMERA_LENS_INFO_AVAILABLE_FOCAL_LENGTHS,
  ACAMERA_LENS_INTRINSIC_CALIBRATION,
  ACAMERA_LENS_OPTICAL_STABILIZATION_MODE,
  ACAMERA_LENS_POSE_REFERENCE,
  ACAMERA_LENS_POSE_ROTATION,
  ACAMERA_LENS_POSE_TRANSLATION,
  ACAMERA_SENSOR_EXPOSURE_TIME,
  ACAMERA_SENSOR_INFO_ACTIVE_ARRAY_SIZE,
  ACAMERA_SENSOR_INFO_PHYSICAL_SIZE,
  ACAMERA_SENSOR_INFO_PRE_CORRECTION_ACTIVE_ARRAY_SIZE,
  ACAMERA_SENSOR_INFO_TIMESTAMP_SOURCE,
  ACAMERA_SENSOR_ORIENTATION,
  ACAMERA_SENSOR_ROLLING_SHUTTER_SKEW,
  ACAMERA_SENSOR_TIMESTAMP
} acamera_metadata_tag_t;
enum {
  ACAMERA_LENS_FACING_BACK = 1,
  ACAMERA_LENS_POSE_REFERENCE_GYROSCOPE = 1,
  ACAMERA_SENSOR_INFO_TIMESTAMP_SOURCE_REALTIME = 1
};
struct ACameraMetadata;
struct ACameraMetadata_const_entry {
  uint32_t tag;
  uint8_t type;
  uint32_t count;
  union {
    const uint8_t* u8;
    const int32_t* i32;
    const float* f;
    const int64_t* i64;
  } data;
};
camera_status_t ACameraMetadata_getConstEntry(const ACameraMetadata* metadata, uint32_t tag,
                                              ACameraMetadata_const_entry* entry);
void ACameraMetadata_free(ACameraMetadata* metadata);
}
