// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <optional>
#include <thread>

#include "plugins/shared/camera/frame_view.hpp"
#include "plugins/vo/vit/vit_system.hpp"
#include "sdk/math/rotation.hpp"

namespace {

using namespace odograph::vit;
using Eigen::Isometry3d;

/// Empirical, not tuned: the interface provides no uncertainty.
struct Parameters {
  std::chrono::microseconds poll{200};   ///< interval between polls for a pose
  int64_t silent_ns = 1'000'000'000;     ///< ns without a pose after which the system is lost
  double rotation_sigma_rad = 0.002;     ///< rad, of a motion
  double displacement_sigma = 0.02;      ///< of a motion's displacement, relative, in addition to
  double min_displacement_sigma = 1e-3;  ///< m
};
constexpr Parameters kParameters;

/// Any system with Monado's VIT interface as a front-end.
class Vit {
 public:
  std::string library, config;
  double wait = 0.1;

  static constexpr odo::Description description{
      "vo/vit", "1.0.0", "A visual-inertial system behind Monado's VIT interface (Basalt and others)",
      ODO_INTERFACE_VO_FRONTEND};
  static std::vector<odo::Parameter<Vit>> parameters() {
    return {
        odo::text("library", &Vit::library, "shared library of the system: beside the config, or found by the loader"),
        odo::text("config", &Vit::config, "the system's own config file, beside this one; empty = its defaults"),
        odo::real("wait", "s", 0, 10, &Vit::wait, "longest time to wait for a frame's pose")};
  }

  void configured(odo::Output& host) {
    if (library.empty()) throw odo::Error(ODO_E_CONFIG, "library: expected the shared library of a VIT system");
    if (const auto file = host.asset(library)) library = *file;
    if (!config.empty()) {
      const auto file = host.asset(config);
      if (!file) throw odo::Error(ODO_E_CONFIG, "config: no file '" + config + "' beside the config");
      config = *file;
    }
    try {
      system_.emplace(library, config);
    } catch (const std::runtime_error& error) {
      throw odo::Error(ODO_E_CONFIG, error.what());
    }
  }

  void on(const odo_calibration& c, odo::Output&) {
    camera_.take(c);
    T_b_c_ = Isometry3d::Identity();
    Eigen::Quaterniond q = odograph::rear_camera_mount();
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS) {
      q = odograph::raw_quaternion(c.q_b_c);
      T_b_c_.translation() = Eigen::Vector3d(c.p_b_c);
    }
    T_b_c_.linear() = q.toRotationMatrix();
    if (started_) return;  // the interface accepts calibrations before the start only
    system_->calibrate(calibration_of(c));
  }

  void on(const odo_imu& imu, odo::Output&) {
    start();
    system_->push({imu.header.t_ns, static_cast<float>(imu.accel_b[0]), static_cast<float>(imu.accel_b[1]),
                   static_cast<float>(imu.accel_b[2]), static_cast<float>(imu.gyro_b[0]),
                   static_cast<float>(imu.gyro_b[1]), static_cast<float>(imu.gyro_b[2])});
  }

  void on(const odo_frame& frame, odo::Output& output) {
    camera_.lens_of(frame);  // the interface has no lens per frame
    start();
    const cv::Mat grey = odograph::grey_of(frame, converted_);
    const auto stride = static_cast<uint32_t>(grey.step);
    system_->push(vit_img_sample{0, frame.header.t_ns, grey.data, frame.width, frame.height, stride,
                                 stride * frame.height, VIT_IMAGE_FORMAT_L8, 0, nullptr});
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(wait);
    do {
      while (const auto pose = system_->pop()) take(*pose, output);
      if (last_ns_ != INT64_MIN && last_ns_ >= frame.header.t_ns) return;
      std::this_thread::sleep_for(kParameters.poll);
    } while (std::chrono::steady_clock::now() < until);
    if (first_ns_ == INT64_MIN) first_ns_ = frame.header.t_ns;
    if (frame.header.t_ns - std::max(first_ns_, last_ns_) > kParameters.silent_ns) lost(frame, output);
  }

 private:
  void start() {
    if (!std::exchange(started_, true)) system_->start();
  }

  vit_camera_calibration calibration_of(const odo_calibration& c) const {
    vit_camera_calibration v{};
    v.width = static_cast<int>(c.width), v.height = static_cast<int>(c.height);
    v.fx = c.fx, v.fy = c.fy, v.cx = c.cx, v.cy = c.cy;
    v.distortion_count = c.distortion_count;
    std::copy_n(c.distortion, c.distortion_count, v.distortion);
    v.model = c.distortion_count == 0                ? VIT_CAMERA_DISTORTION_NONE
              : c.model == ODO_CAMERA_KANNALA_BRANDT ? VIT_CAMERA_DISTORTION_KB4
              : c.distortion_count == 4              ? VIT_CAMERA_DISTORTION_RT4
              : c.distortion_count == 5              ? VIT_CAMERA_DISTORTION_RT5
                                                     : VIT_CAMERA_DISTORTION_RT8;
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>{v.transform} = T_b_c_.matrix();
    return v;
  }

  void take(const vit_pose_data& pose, odo::Output& output) {
    const Eigen::Quaterniond q(pose.ow, pose.ox, pose.oy, pose.oz);
    if (!(std::abs(q.norm() - 1) < 0.01) || pose.timestamp <= last_ns_) return;  // invalid pose
    Isometry3d T_w_b = Isometry3d::Identity();
    T_w_b.linear() = q.normalized().toRotationMatrix();
    T_w_b.translation() = Eigen::Vector3d(pose.px, pose.py, pose.pz);
    const Isometry3d T_w_c = T_w_b * T_b_c_;
    const int64_t from_ns = std::exchange(last_ns_, pose.timestamp);
    const Isometry3d step = std::exchange(T_w_c_, T_w_c).inverse() * T_w_c;
    if (from_ns == INT64_MIN) return;
    auto event = odo::make<odo_vo_motion>(pose.timestamp);
    event.t_from_ns = from_ns;
    const double length = step.translation().norm();
    odograph::put_motion(Eigen::Quaterniond(step.linear()), step.translation(), kParameters.rotation_sigma_rad,
                         kParameters.displacement_sigma * length + kParameters.min_displacement_sigma, event);
    event.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_METRIC;
    event.camera = camera_.calibration()->header.source;
    event.state = ODO_TRACKING;
    output.emit(event);
  }

  void lost(const odo_frame& frame, odo::Output& output) {
    if (last_ns_ == INT64_MIN) last_ns_ = first_ns_;
    auto event = odo::make<odo_vo_motion>(frame.header.t_ns);
    event.t_from_ns = std::exchange(last_ns_, frame.header.t_ns);
    event.q_c0_c1[0] = 1;
    event.camera = camera_.calibration()->header.source;
    event.state = ODO_LOST;
    event.reason = ODO_REASON_INITIALISING;
    output.emit(event);
  }

  std::optional<System> system_;
  Isometry3d T_b_c_ = Isometry3d::Identity(), T_w_c_ = Isometry3d::Identity();
  cv::Mat converted_;
  odograph::CalibratedCamera camera_;
  int64_t last_ns_ = INT64_MIN, first_ns_ = INT64_MIN;
  bool started_ = false;
};

}  // namespace

ODO_PLUGIN(Vit)
