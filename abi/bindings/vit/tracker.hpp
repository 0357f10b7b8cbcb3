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
      timing;  ///< monotonic clock, ns: frame received, processing started, pose available
  std::optional<std::vector<vit_pose_feature>> features;  ///< of `camera`
  uint32_t camera;
};

/// A session behind Monado's VIT interface. A worker thread orders the input of the consumer's threads by time, each
/// frame after the IMU samples that cover it, so that poses depend only on the input.
class VitTracker {
 public:
  /// `config`: YAML file of a pipeline; null: the recommended pipeline. Throws odo::Error.
  explicit VitTracker(const char* config);
  ~VitTracker() { stop(); }

  void start();
  void stop();  ///< processes all pushed input first
  void reset();
  bool running() const;

  void push(const vit_imu_sample& sample);
  void push(const vit_img_sample& sample);  ///< copies it; blocks while the queue is full
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
  std::unique_ptr<odo::Session> session_;  ///< used by the worker while it runs
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

  // Used by the worker only.
  bool described_ = false;
  int64_t last_pose_ns_ = INT64_MIN, received_ns_ = 0, processing_ns_ = 0;
  std::optional<odo_vo_motion> motion_;
  std::vector<odo_pose> come_;
};
