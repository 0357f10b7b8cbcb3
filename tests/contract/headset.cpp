// SPDX-License-Identifier: Apache-2.0
//
// A consumer of Monado's VIT interface, as written by others: it loads libodograph_vit.so by the names of its 21
// functions and plays a recording into it, the IMU on one thread at full speed, pictures on another, poses fetched from
// two. They must equal those of `odograph run` over the same recording with inertial samples rounded to the interface's
// precision.
// odograph-headset LIBRARY CONFIG RECORDING
#include <dlfcn.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "plugins/vo/vit/vit_interface.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/replay/runner.hpp"

using namespace odograph;
using Eigen::Isometry3d;

namespace {

int failures = 0;
void check(bool good, const std::string& what) {
  if (good) return;
  std::printf("FAILED: %s\n", what.c_str());
  ++failures;
}

/// Every function of the interface, by name.
struct Library {
  void* handle;
  explicit Library(const char* path) : handle(dlopen(path, RTLD_NOW | RTLD_LOCAL)) {
    if (!handle) std::printf("%s\n", dlerror()), std::exit(1);
  }
  template <class Result = vit_result, class... Arguments>
  Result call(const char* name, Arguments... arguments) const {
    auto* function = reinterpret_cast<Result (*)(Arguments...)>(dlsym(handle, (std::string("vit_") + name).c_str()));
    if (!function) std::printf("FAILED: no vit_%s\n", name), std::exit(1);
    return function(arguments...);
  }
};

struct Fetched {
  vit_pose_data data;
  std::vector<int64_t> timing;
  uint32_t features;
};

class Consumer {
 public:
  Consumer(const Library& library, const char* config) : library_(library) {
    const vit_config options{config, 1, 0, false};
    check(library_.call("tracker_create", &options, &tracker_) == VIT_SUCCESS && tracker_, "vit_tracker_create");
  }
  ~Consumer() { library_.call<void>("tracker_destroy", tracker_); }

  template <class... Arguments>
  void expect(vit_result result, const char* name, Arguments... arguments) {
    const vit_result got = library_.call(name, tracker_, arguments...);
    check(got == result, std::string(name) + " gave " + std::to_string(got));
  }

  void describe(const Recording& recording) {
    for (const RecordedMessage& m : recording.messages) {
      if (m.message.header().type == ODO_TYPE_CALIBRATION) describe(copy_as<odo_calibration>(m.message.header()));
      if (m.message.header().type == ODO_TYPE_IMU_NOISE) describe(copy_as<odo_imu_noise>(m.message.header()));
    }
  }

  /// Until the time `until_ns`.
  void play(const Recording& recording, int64_t until_ns) {
    std::thread inertial([&] {
      for (const RecordedMessage& m : recording.messages)
        if (m.message.header().type == ODO_TYPE_IMU && m.message.header().t_ns <= until_ns)
          push(copy_as<odo_imu>(m.message.header()));
    });
    std::atomic<bool> done{false};
    std::thread pictures([&] {
      for (const RecordedMessage& m : recording.messages) {
        if (m.message.header().type != ODO_TYPE_FRAME || m.message.header().t_ns > until_ns) continue;
        fetch();
        const auto frame = load_frame(m);
        if (!frame) continue;
        push(*frame);
        frame->loan.release(frame->loan.owner);
      }
      done = true;
    });
    while (!done) fetch(), std::this_thread::sleep_for(std::chrono::milliseconds(5));
    inertial.join(), pictures.join();
  }

  void fetch() {
    for (vit_pose* pose = nullptr; library_.call("tracker_pop_pose", tracker_, &pose) == VIT_SUCCESS && pose;) {
      Fetched f{};
      vit_pose_timing timing{};
      vit_pose_features features{};
      check(library_.call("pose_get_data", static_cast<const vit_pose*>(pose), &f.data) == VIT_SUCCESS, "data");
      check(library_.call("pose_get_timing", static_cast<const vit_pose*>(pose), &timing) == VIT_SUCCESS, "timing");
      check(
          library_.call("pose_get_features", static_cast<const vit_pose*>(pose), uint32_t{0}, &features) == VIT_SUCCESS,
          "features");
      f.timing.assign(timing.timestamps, timing.timestamps + timing.count);
      f.features = features.count;
      library_.call<void>("pose_destroy", pose);
      const std::lock_guard lock(mutex_);
      poses[f.data.timestamp] = f;
    }
  }

  std::map<int64_t, Fetched> poses;

 private:
  void describe(const odo_calibration& c) {
    vit_camera_calibration v{};
    v.width = static_cast<int>(c.width), v.height = static_cast<int>(c.height);
    v.fx = c.fx, v.fy = c.fy, v.cx = c.cx, v.cy = c.cy;
    v.model = c.distortion_count == 0 ? VIT_CAMERA_DISTORTION_NONE : VIT_CAMERA_DISTORTION_RT4;
    v.distortion_count = c.distortion_count;
    std::copy_n(c.distortion, c.distortion_count, v.distortion);
    Isometry3d mount = Isometry3d::Identity();
    mount.linear() = raw_quaternion(c.q_b_c).toRotationMatrix();
    mount.translation() = Eigen::Vector3d(c.p_b_c);
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>{v.transform} = mount.matrix();
    expect(VIT_SUCCESS, "tracker_add_camera_calibration", static_cast<const vit_camera_calibration*>(&v));
  }

  void describe(const odo_imu_noise& n) {
    vit_imu_calibration v{};
    for (int i = 0; i < 3; ++i) {
      v.gyro.transform[4 * i] = v.accel.transform[4 * i] = 1;
      v.gyro.noise_std[i] = n.gyro_noise, v.gyro.bias_std[i] = n.gyro_walk;
      v.accel.noise_std[i] = n.accel_noise, v.accel.bias_std[i] = n.accel_walk;
    }
    expect(VIT_SUCCESS, "tracker_add_imu_calibration", static_cast<const vit_imu_calibration*>(&v));
  }

  void push(const odo_imu& imu) {
    const auto f = [](double x) { return static_cast<float>(x); };
    const vit_imu_sample sample{imu.header.t_ns,  f(imu.accel_b[0]), f(imu.accel_b[1]), f(imu.accel_b[2]),
                                f(imu.gyro_b[0]), f(imu.gyro_b[1]),  f(imu.gyro_b[2])};
    expect(VIT_SUCCESS, "tracker_push_imu_sample", &sample);
  }

  void push(const odo_frame& frame) {
    const auto stride = static_cast<uint32_t>(frame.planes[0].row_stride);
    std::vector<uint8_t> pixels(frame.planes[0].data, frame.planes[0].data + size_t{stride} * frame.height);
    const vit_img_sample sample{0,      frame.header.t_ns,     pixels.data(),       frame.width, frame.height,
                                stride, stride * frame.height, VIT_IMAGE_FORMAT_L8, 0,           nullptr};
    expect(VIT_SUCCESS, "tracker_push_img_sample", &sample);
    std::fill(pixels.begin(), pixels.end(), uint8_t{0});  // the consumer reuses it
  }

  const Library& library_;
  vit_tracker* tracker_ = nullptr;
  std::mutex mutex_;
};

void check_refusals(const Library& library) {
  uint32_t version[3] = {};
  library.call("api_get_version", &version[0], &version[1], &version[2]);
  check(version[0] == 2 && version[1] == 0, "another version");
  vit_tracker* none = nullptr;
  const vit_config nowhere{"/nowhere/walk.yaml", 1, 1, false}, blind{nullptr, 0, 1, false};
  check(library.call("tracker_create", &nowhere, &none) == VIT_ERROR_INVALID_VALUE && !none,
        "a config that is not there");
  check(library.call("tracker_create", &blind, &none) == VIT_ERROR_INVALID_VALUE && !none, "no camera");
}

void check_extensions(const Library& library, Consumer& consumer) {
  vit_tracker_extension_set set{};
  consumer.expect(VIT_SUCCESS, "tracker_get_supported_extensions", &set);
  check(set.has_add_camera_calibration && set.has_add_imu_calibration && set.has_pose_timing && set.has_pose_features,
        "extensions");
  consumer.expect(VIT_SUCCESS, "tracker_get_enabled_extensions", &set);
  check(!set.has_pose_timing && !set.has_pose_features, "timing is enabled without a wish");
  for (const auto extension : {VIT_TRACKER_EXTENSION_POSE_TIMING, VIT_TRACKER_EXTENSION_POSE_FEATURES})
    consumer.expect(VIT_SUCCESS, "tracker_enable_extension", extension, true);
  consumer.expect(VIT_ERROR_NOT_SUPPORTED, "tracker_enable_extension", static_cast<vit_tracker_extension>(9), true);
  consumer.expect(VIT_SUCCESS, "tracker_get_enabled_extensions", &set);
  check(set.has_pose_timing && set.has_pose_features, "what was enabled is not");
  bool grey = false, deep = true, running = true;
  consumer.expect(VIT_SUCCESS, "tracker_has_image_format", VIT_IMAGE_FORMAT_L8, &grey);
  consumer.expect(VIT_SUCCESS, "tracker_has_image_format", VIT_IMAGE_FORMAT_L16, &deep);
  consumer.expect(VIT_SUCCESS, "tracker_is_running", &running);
  check(grey && !deep && !running, "formats, or it runs before its start");
  vit_tracker_timing_titles titles{};
  consumer.expect(VIT_SUCCESS, "tracker_get_timing_titles", &titles);
  check(titles.count == 3 && std::strlen(titles.titles[2]) > 0, "titles");
  (void)library;
}

/// The body's pose in a world with z up.
Isometry3d pose_of(const vit_pose_data& d) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(d.ow, d.ox, d.oy, d.oz).normalized().toRotationMatrix();
  T.translation() = Eigen::Vector3d(d.px, d.py, d.pz);
  return T;
}

void compare(const RunResult& run, const odo_calibration& calibration, const std::map<int64_t, Fetched>& poses) {
  Isometry3d T_b_c = Isometry3d::Identity(), T_u_n = Isometry3d::Identity();
  T_b_c.linear() = raw_quaternion(calibration.q_b_c).toRotationMatrix();
  T_b_c.translation() = Eigen::Vector3d(calibration.p_b_c);
  T_u_n.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  double metres = 0, radians = 0;
  size_t compared = 0, timed = 0, followed = 0;
  for (size_t i = run.first_metric; i < run.track.size(); ++i) {
    const auto found = poses.find(run.track[i].t_ns);
    if (found == poses.end()) continue;
    Isometry3d T_n_c = Isometry3d::Identity();
    T_n_c.linear() = run.track[i].q.toRotationMatrix(), T_n_c.translation() = run.track[i].p;
    const Isometry3d off = (T_u_n * T_n_c * T_b_c.inverse()).inverse() * pose_of(found->second.data);
    metres = std::max(metres, off.translation().norm());
    radians = std::max(radians, Eigen::AngleAxisd(off.linear()).angle());
    const auto& t = found->second.timing;
    timed += t.size() == 3 && t[0] > 0 && t[0] <= t[1] && t[1] <= t[2];
    followed += found->second.features > 20;
    ++compared;
  }
  const size_t expected = run.track.size() - run.first_metric;
  std::printf(
      "%zu poses of %zu; largest difference from odograph run %.2e m and %.2e rad; %zu timed, %zu with features\n",
      compared, expected, metres, radians, timed, followed);
  check(compared + 1 >= expected && poses.size() <= expected && expected > 50, "poses are missing");
  check(metres < 1e-5 && radians < 1e-5, "they are not odograph run's");
  check(timed == compared && followed > compared / 2, "times or features");
}

/// Reduces a recording to the interface's content: no exposures, no row times, inertial samples in single precision.
/// Returns the camera.
odo_calibration reduce(Recording& recording) {
  odo_calibration calibration{};
  std::erase_if(recording.messages, [](const RecordedMessage& m) {
    const uint32_t type = m.message.header().type;
    return type != ODO_TYPE_IMU && type != ODO_TYPE_FRAME && type != ODO_TYPE_CALIBRATION && type != ODO_TYPE_IMU_NOISE;
  });
  for (RecordedMessage& m : recording.messages) {
    odo_header& header = m.message.header();
    if (header.type == ODO_TYPE_CALIBRATION) {
      auto& c = reinterpret_cast<odo_calibration&>(header);
      c.header.flags &= ODO_CALIBRATION_EXTRINSICS;
      c.time_offset_ns = c.line_time_ns = 0;
      calibration = copy_as<odo_calibration>(header);
    }
    if (header.type == ODO_TYPE_FRAME) {
      auto& f = reinterpret_cast<odo_frame&>(header);
      f.header.flags = 0, f.exposure_ns = f.line_time_ns = 0;
    }
    if (header.type != ODO_TYPE_IMU) continue;
    auto& imu = reinterpret_cast<odo_imu&>(header);
    for (int i = 0; i < 3; ++i) {
      volatile float gyro = static_cast<float>(imu.gyro_b[i]), accel = static_cast<float>(imu.accel_b[i]);
      imu.gyro_b[i] = gyro, imu.accel_b[i] = accel;  // volatile: g++ 12 -O3 leaves two of the six as they were
    }
  }
  return calibration;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::printf("usage: odograph-headset LIBRARY CONFIG RECORDING\n"), 2;
  auto recording = read_recording(argv[3]);
  if (!recording) return std::printf("%s\n", recording.failure().text.c_str()), 1;
  const odo_calibration calibration = reduce(*recording);
  RunOptions options;
  options.config = argv[2];
  const auto run = replay(*recording, options);
  if (!run) return std::printf("%s\n", run.failure().text.c_str()), 1;

  const Library library(argv[1]);
  check_refusals(library);
  Consumer consumer(library, argv[2]);
  check_extensions(library, consumer);
  consumer.describe(*recording);
  consumer.expect(VIT_SUCCESS, "tracker_start");
  const int64_t end_ns = recording->messages.back().message.header().t_ns;
  consumer.play(*recording, end_ns / 2 + run->track.front().t_ns / 2);
  consumer.expect(VIT_SUCCESS, "tracker_reset");  // discards all of that
  consumer.poses.clear();
  consumer.play(*recording, end_ns);
  consumer.expect(VIT_SUCCESS, "tracker_stop");
  consumer.fetch();
  compare(*run, calibration, consumer.poses);
  return failures > 0;
}
