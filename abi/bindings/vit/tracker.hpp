// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <odograph/odograph.hpp>

#include "plugins/vo/vit/vit_interface.hpp"

struct vit_pose {
  vit_pose_data data;
  std::optional<std::vector<int64_t>>
      timing;  ///< monotonic clock, ns; of the frame received, its processing begun, the pose known
  std::optional<std::vector<vit_pose_feature>> features;  ///< of `camera`
  uint32_t camera;
};

/// One session behind Monado's VIT interface. What a consumer pushes from its threads is brought into the order of time
/// by a thread of the tracker's own: each frame after the IMU samples that cover it, so that poses depend on the input
/// alone.
class VitTracker {
 public:
  /// `config`: a pipeline's YAML file; null: the recommended pipeline. Throws odo::Error.
  explicit VitTracker(const char* config);
  ~VitTracker() { stop(); }

  void start();
  void stop();  ///< after all that was pushed
  void reset();
  bool running() const;

  void push(const vit_imu_sample& sample);
  void push(const vit_img_sample& sample);  ///< copies it; waits while many are in the queue
  void add(const vit_camera_calibration& calibration);
  void add(const vit_imu_calibration& calibration);
  std::unique_ptr<vit_pose> pop();

  vit_tracker_extension_set extensions() const;
  void enable(const vit_tracker_extension_set& set);

 private:
  struct Picture {
    odo_frame frame;
    int64_t received_ns;
    std::vector<uint8_t> pixels;
  };
  void open();
  void run();
  void wait_for_imu(std::unique_lock<std::mutex>& lock, int64_t t_ns);
  void describe(int64_t t_ns);
  void process(const std::shared_ptr<Picture>& picture, const std::vector<vit_imu_sample>& samples);
  void take(const odo::Event& event);
  void take_poses();
  void take(const odo_pose& pose);

  odo::Options options_;
  std::unique_ptr<odo::Session> session_;  ///< the worker's while it runs
  std::vector<odo_calibration> calibrations_;
  std::optional<odo_imu_noise> noise_;
  std::optional<vit_imu_calibration> imu_calibration_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::thread worker_;
  bool running_ = false;
  vit_tracker_extension_set extensions_{true, true, false, false};
  std::deque<vit_imu_sample> samples_;
  std::deque<std::shared_ptr<Picture>> pictures_;
  std::deque<std::unique_ptr<vit_pose>> poses_;
  int64_t newest_imu_ns_ = INT64_MIN;
  std::chrono::steady_clock::time_point imu_came_;

  // The worker's.
  bool described_ = false;
  int64_t last_pose_ns_ = INT64_MIN, received_ns_ = 0, processing_ns_ = 0;
  std::optional<odo_vo_motion> motion_;
  std::vector<odo_pose> come_;
};
