// SPDX-License-Identifier: Apache-2.0
//
// A VIT system for the test of vo/vit: it integrates the gyroscope, moves along the body's x by a tenth of a metre per
// picture that is not uniform, and answers from its own thread, as real systems do. With a config file containing
// "silent" it answers nothing.
#include <condition_variable>
#include <deque>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>

#include <Eigen/Geometry>

#include "plugins/vo/vit/vit_interface.hpp"

struct vit_pose {
  vit_pose_data data;
};

struct vit_tracker {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::pair<int64_t, bool>> pictures;
  std::deque<vit_imu_sample> samples;
  std::deque<vit_pose_data> poses;
  std::thread thread;
  bool stop = false, silent = false, calibrated = false;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  double x = 0;
  int64_t last_ns = 0;

  void work() {
    std::unique_lock lock(mutex);
    while (!stop) {
      changed.wait(lock, [this] { return stop || !pictures.empty(); });
      if (stop) return;
      const auto [t_ns, structured] = pictures.front();
      pictures.pop_front();
      for (; !samples.empty() && samples.front().timestamp <= t_ns; samples.pop_front()) {
        const vit_imu_sample& s = samples.front();
        if (last_ns > 0) {
          const Eigen::Vector3d rotation =
              Eigen::Vector3d(s.wx, s.wy, s.wz) * (static_cast<double>(s.timestamp - last_ns) * 1e-9);
          if (rotation.norm() > 0)
            q = q * Eigen::Quaterniond(Eigen::AngleAxisd(rotation.norm(), rotation.normalized()));
        }
        last_ns = s.timestamp;
      }
      if (structured && calibrated) x += 0.1;
      if (silent) continue;
      poses.push_back({t_ns, static_cast<float>(x), 0, 0, static_cast<float>(q.x()), static_cast<float>(q.y()),
                       static_cast<float>(q.z()), static_cast<float>(q.w()), 0, 0, 0});
    }
  }
};

namespace {
std::string text_of(const char* file) {
  std::string text;
  if (file) std::getline(std::ifstream(file), text);
  return text;
}
}  // namespace

extern "C" {

vit_result vit_api_get_version(uint32_t* major, uint32_t* minor, uint32_t* patch) {
  *major = 1, *minor = 0, *patch = 1;
  return VIT_SUCCESS;
}

vit_result vit_tracker_create(const vit_config* config, vit_tracker** tracker) {
  if (config->cam_count != 1 || config->imu_count != 1) return static_cast<vit_result>(-2);
  *tracker = new vit_tracker;
  (*tracker)->silent = text_of(config->file) == "silent";
  return VIT_SUCCESS;
}

void vit_tracker_destroy(vit_tracker* tracker) { delete tracker; }

vit_result vit_tracker_start(vit_tracker* tracker) {
  tracker->thread = std::thread([tracker] { tracker->work(); });
  return VIT_SUCCESS;
}

vit_result vit_tracker_stop(vit_tracker* tracker) {
  {
    const std::lock_guard lock(tracker->mutex);
    tracker->stop = true;
  }
  tracker->changed.notify_all();
  tracker->thread.join();
  return VIT_SUCCESS;
}

vit_result vit_tracker_push_imu_sample(vit_tracker* tracker, const vit_imu_sample* sample) {
  const std::lock_guard lock(tracker->mutex);
  tracker->samples.push_back(*sample);
  return VIT_SUCCESS;
}

vit_result vit_tracker_push_img_sample(vit_tracker* tracker, const vit_img_sample* sample) {
  bool structured = false;
  for (uint32_t i = 1; i < sample->width; ++i) structured |= sample->data[i] != sample->data[0];
  {
    const std::lock_guard lock(tracker->mutex);
    tracker->pictures.emplace_back(sample->timestamp, structured);
  }
  tracker->changed.notify_all();
  return VIT_SUCCESS;
}

vit_result vit_tracker_add_camera_calibration(vit_tracker* tracker, const vit_camera_calibration* calibration) {
  tracker->calibrated = calibration->fx > 0 && calibration->transform[15] == 1;
  return VIT_SUCCESS;
}

vit_result vit_tracker_pop_pose(vit_tracker* tracker, vit_pose** pose) {
  const std::lock_guard lock(tracker->mutex);
  *pose = nullptr;
  if (tracker->poses.empty()) return VIT_SUCCESS;
  *pose = new vit_pose{tracker->poses.front()};
  tracker->poses.pop_front();
  return VIT_SUCCESS;
}

void vit_pose_destroy(vit_pose* pose) { delete pose; }

vit_result vit_pose_get_data(const vit_pose* pose, vit_pose_data* data) {
  *data = pose->data;
  return VIT_SUCCESS;
}
}
