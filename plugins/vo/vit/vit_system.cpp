// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/vit/vit_system.hpp"

#include <dlfcn.h>

#include <stdexcept>

namespace odograph::vit {

void System::Close::operator()(void* handle) const { dlclose(handle); }

template <class Function>
Function* System::find(const char* name, bool required) const {
  auto* function = reinterpret_cast<Function*>(dlsym(handle_.get(), name));
  if (!function && required) throw std::runtime_error(library_ + ": not a VIT system: missing function " + name);
  return function;
}

void System::check(vit_result result, const char* what) const {
  if (result < 0) throw std::runtime_error(library_ + ": " + what + " failed with " + std::to_string(result));
}

System::System(const std::string& library, const std::string& config) : library_(library) {
  handle_.reset(dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL));
  if (!handle_) throw std::runtime_error(std::string("cannot be loaded: ") + dlerror());
  uint32_t major = 0, minor = 0, patch = 0;
  check(find<vit_api_get_version_t>("vit_api_get_version")(&major, &minor, &patch), "vit_api_get_version");
  version_ = std::to_string(major) + '.' + std::to_string(minor) + '.' + std::to_string(patch);
  if (major < 1 || major > 2)
    throw std::runtime_error(library + ": VIT " + version_ + "; versions 1 and 2 are supported");
  auto* create = find<vit_tracker_create_t>("vit_tracker_create");
  destroy_ = find<vit_tracker_destroy_t>("vit_tracker_destroy");
  start_ = find<vit_tracker_start_t>("vit_tracker_start");
  stop_ = find<vit_tracker_stop_t>("vit_tracker_stop");
  push_imu_ = find<vit_tracker_push_imu_sample_t>("vit_tracker_push_imu_sample");
  push_image_ = find<vit_tracker_push_img_sample_t>("vit_tracker_push_img_sample");
  add_calibration_ = find<vit_tracker_add_camera_calibration_t>("vit_tracker_add_camera_calibration", false);
  pop_ = find<vit_tracker_pop_pose_t>("vit_tracker_pop_pose");
  destroy_pose_ = find<vit_pose_destroy_t>("vit_pose_destroy");
  pose_data_ = find<vit_pose_get_data_t>("vit_pose_get_data");
  const vit_config options{config.empty() ? nullptr : config.c_str(), 1, 1, false};
  check(create(&options, &tracker_), "vit_tracker_create");
  if (!tracker_) throw std::runtime_error(library + ": vit_tracker_create returned no tracker");
}

System::~System() {
  if (started_) stop_(tracker_);
  if (tracker_) destroy_(tracker_);
}

void System::calibrate(const vit_camera_calibration& calibration) {
  if (!add_calibration_) return;
  const vit_result result = add_calibration_(tracker_, &calibration);
  if (result != VIT_ERROR_NOT_SUPPORTED) check(result, "vit_tracker_add_camera_calibration");
}

void System::start() {
  if (started_) return;
  check(start_(tracker_), "vit_tracker_start");
  started_ = true;
}

void System::push(const vit_imu_sample& sample) { check(push_imu_(tracker_, &sample), "vit_tracker_push_imu_sample"); }

void System::push(const vit_img_sample& sample) {
  check(push_image_(tracker_, &sample), "vit_tracker_push_img_sample");
}

std::optional<vit_pose_data> System::pop() {
  vit_pose* pose = nullptr;
  check(pop_(tracker_, &pose), "vit_tracker_pop_pose");
  if (!pose) return std::nullopt;
  vit_pose_data data{};
  const vit_result result = pose_data_(pose, &data);
  destroy_pose_(pose);
  check(result, "vit_pose_get_data");
  return data;
}

}  // namespace odograph::vit
