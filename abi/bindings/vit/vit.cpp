// SPDX-License-Identifier: Apache-2.0
//
// libodograph_vit.so: Odograph as a VIT system, for Monado and other consumers. Implements the 21 functions of the
// interface, version 2.0, with the public C API.
#include <cstdio>
#include <exception>
#include <new>

#include "abi/bindings/vit/tracker.hpp"

#define VIT_API extern "C" __attribute__((visibility("default")))

struct vit_tracker {
  explicit vit_tracker(const char* config) : tracker(config) {}
  VitTracker tracker;
};

namespace {

/// Writes the reason of a failure to standard error, because the interface has no error texts.
vit_result refused(const char* text) {
  std::fprintf(stderr, "odograph_vit: %s\n", text);
  return VIT_ERROR_INVALID_VALUE;
}

/// Converts exceptions to results.
template <class Work>
vit_result guarded(Work work) {
  try {
    work();
    return VIT_SUCCESS;
  } catch (const std::bad_alloc&) {
    return VIT_ERROR_ALLOCATION_FAILURE;
  } catch (const std::exception& error) {
    return refused(error.what());
  }
}

bool* member(vit_tracker_extension_set& set, vit_tracker_extension extension) {
  switch (extension) {
    case VIT_TRACKER_EXTENSION_ADD_CAMERA_CALIBRATION: return &set.has_add_camera_calibration;
    case VIT_TRACKER_EXTENSION_ADD_IMU_CALIBRATION: return &set.has_add_imu_calibration;
    case VIT_TRACKER_EXTENSION_POSE_TIMING: return &set.has_pose_timing;
    case VIT_TRACKER_EXTENSION_POSE_FEATURES: return &set.has_pose_features;
  }
  return nullptr;
}

bool is_supported(vit_image_format format) {
  return format == VIT_IMAGE_FORMAT_L8 || format == VIT_IMAGE_FORMAT_R8G8B8;
}

}  // namespace

VIT_API vit_result vit_api_get_version(uint32_t* major, uint32_t* minor, uint32_t* patch) {
  *major = 2, *minor = 0, *patch = 1;
  return VIT_SUCCESS;
}

/// `imu_count` is 0 when Monado replays a data set. Only one IMU is supported.
VIT_API vit_result vit_tracker_create(const vit_config* config, vit_tracker** tracker) {
  if (!config || !tracker) return VIT_ERROR_INVALID_VALUE;
  *tracker = nullptr;
  if (config->cam_count == 0 || config->imu_count > 1) return refused("expected at least one camera, and one IMU");
  return guarded([&] { *tracker = new vit_tracker(config->file); });
}

VIT_API void vit_tracker_destroy(vit_tracker* tracker) { delete tracker; }

VIT_API vit_result vit_tracker_has_image_format(const vit_tracker*, vit_image_format format, bool* supported) {
  *supported = is_supported(format);
  return VIT_SUCCESS;
}

VIT_API vit_result vit_tracker_get_supported_extensions(const vit_tracker*, vit_tracker_extension_set* extensions) {
  *extensions = {true, true, true, true};
  return VIT_SUCCESS;
}

VIT_API vit_result vit_tracker_get_enabled_extensions(const vit_tracker* t, vit_tracker_extension_set* extensions) {
  *extensions = t->tracker.extensions();
  return VIT_SUCCESS;
}

VIT_API vit_result vit_tracker_enable_extension(vit_tracker* t, vit_tracker_extension extension, bool enable) {
  auto extensions = t->tracker.extensions();
  bool* const one = member(extensions, extension);
  if (!one) return VIT_ERROR_NOT_SUPPORTED;
  *one = enable;
  t->tracker.enable(extensions);
  return VIT_SUCCESS;
}

VIT_API vit_result vit_tracker_start(vit_tracker* t) {
  return guarded([&] { t->tracker.start(); });
}

VIT_API vit_result vit_tracker_stop(vit_tracker* t) {
  return guarded([&] { t->tracker.stop(); });
}

VIT_API vit_result vit_tracker_reset(vit_tracker* t) {
  return guarded([&] { t->tracker.reset(); });
}

VIT_API vit_result vit_tracker_is_running(const vit_tracker* t, bool* running) {
  *running = t->tracker.running();
  return VIT_SUCCESS;
}

VIT_API vit_result vit_tracker_push_imu_sample(vit_tracker* t, const vit_imu_sample* sample) {
  return guarded([&] { t->tracker.push(*sample); });
}

VIT_API vit_result vit_tracker_push_img_sample(vit_tracker* t, const vit_img_sample* sample) {
  const uint64_t pixel = sample->format == VIT_IMAGE_FORMAT_R8G8B8 ? 3 : 1;
  const bool whole = sample->data && sample->width > 0 && sample->height > 0 &&
                     sample->stride >= sample->width * pixel && (sample->mask_count == 0 || sample->masks);
  if (!is_supported(sample->format) || !whole)
    return refused("invalid picture; expected L8 or R8G8B8, with rows of at least its width");
  return guarded([&] { t->tracker.push(*sample); });
}

VIT_API vit_result vit_tracker_add_imu_calibration(vit_tracker* t, const vit_imu_calibration* calibration) {
  if (!t->tracker.extensions().has_add_imu_calibration) return VIT_ERROR_NOT_ENABLED;
  if (t->tracker.running()) return refused("calibrations must be added before the start");
  if (calibration->imu_index > 0) return VIT_SUCCESS;  // only one IMU is used
  return guarded([&] { t->tracker.add(*calibration); });
}

VIT_API vit_result vit_tracker_add_camera_calibration(vit_tracker* t, const vit_camera_calibration* calibration) {
  if (!t->tracker.extensions().has_add_camera_calibration) return VIT_ERROR_NOT_ENABLED;
  if (t->tracker.running()) return refused("calibrations must be added before the start");
  if (calibration->model < VIT_CAMERA_DISTORTION_NONE || calibration->model > VIT_CAMERA_DISTORTION_KB4)
    return refused("unknown distortion model");
  return guarded([&] { t->tracker.add(*calibration); });
}

VIT_API vit_result vit_tracker_pop_pose(vit_tracker* t, vit_pose** pose) {
  auto next = t->tracker.pop();
  if (pose) *pose = next.release();
  return VIT_SUCCESS;
}

VIT_API vit_result vit_tracker_get_timing_titles(const vit_tracker*, vit_tracker_timing_titles* titles) {
  static const char* kTitles[] = {"frame_received", "frame_processing", "pose_known"};
  *titles = {3, kTitles};
  return VIT_SUCCESS;
}

VIT_API void vit_pose_destroy(vit_pose* pose) { delete pose; }

VIT_API vit_result vit_pose_get_data(const vit_pose* pose, vit_pose_data* data) {
  *data = pose->data;
  return VIT_SUCCESS;
}

VIT_API vit_result vit_pose_get_timing(const vit_pose* pose, vit_pose_timing* timing) {
  *timing = {};
  if (!pose->timing) return VIT_ERROR_NOT_ENABLED;
  *timing = {static_cast<uint32_t>(pose->timing->size()), pose->timing->data()};
  return VIT_SUCCESS;
}

/// Gives the number of features that the front-end tracked. The C API has neither their ids nor their positions, which
/// are -1 here.
VIT_API vit_result vit_pose_get_features(const vit_pose* pose, uint32_t camera, vit_pose_features* features) {
  *features = {};
  if (!pose->features) return VIT_ERROR_NOT_ENABLED;
  if (camera == pose->camera) *features = {static_cast<uint32_t>(pose->features->size()), pose->features->data()};
  return VIT_SUCCESS;
}
