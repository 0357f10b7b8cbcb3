// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "plugins/vo/vit/vit_interface.hpp"

namespace odograph::vit {

/// A visual-inertial system in a shared library, and one tracker. Throws std::runtime_error with the library and the
/// missing item. Not thread-safe.
class System {
 public:
  /// `library`: a path, or a name for the dynamic loader. `config`: the system's config file; empty = none.
  System(const std::string& library, const std::string& config);
  ~System();
  System(const System&) = delete;
  System& operator=(const System&) = delete;

  /// Call before start(). Does nothing for a system that reads its calibrations from its own file.
  void calibrate(const vit_camera_calibration& calibration);
  void start();
  void push(const vit_imu_sample& sample);
  void push(const vit_img_sample& sample);
  /// The next pose, if available.
  std::optional<vit_pose_data> pop();
  const std::string& version() const { return version_; }

 private:
  template <class Function>
  Function* find(const char* name, bool required = true) const;
  void check(vit_result result, const char* what) const;

  struct Close {
    void operator()(void* handle) const;
  };
  std::string library_, version_;
  std::unique_ptr<void, Close> handle_;
  vit_tracker* tracker_ = nullptr;
  bool started_ = false;
  vit_tracker_destroy_t* destroy_;
  vit_tracker_start_t* start_;
  vit_tracker_stop_t* stop_;
  vit_tracker_push_imu_sample_t* push_imu_;
  vit_tracker_push_img_sample_t* push_image_;
  vit_tracker_add_camera_calibration_t* add_calibration_;
  vit_tracker_pop_pose_t* pop_;
  vit_pose_destroy_t* destroy_pose_;
  vit_pose_get_data_t* pose_data_;
};

}  // namespace odograph::vit
