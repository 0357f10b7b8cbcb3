// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "plugins/shared/camera/frame_view.hpp"
#include "plugins/shared/camera/points_event.hpp"
#include "plugins/shared/sensor_range.hpp"
#include "plugins/vo/odograph/inertial/inertial_odometry.hpp"
#include "plugins/vo/odograph/visual/odometry.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace {

using namespace odograph::vo;
using odograph::put_quaternion;
using odograph::SensorRange;
using odograph::vio::InertialMotion;
using odograph::vio::InertialOdometry;

constexpr int64_t kRefinedEvery_ns = 1'000'000'000;  // period of the refined calibration

class OdographVo {
 public:
  static constexpr odo::Description description{"vo/odograph", "2.0.0",
                                                "Visual-inertial odometry: metric with an accelerometer, up to scale "
                                                "without; rolling shutter, online calibration",
                                                ODO_INTERFACE_VO_FRONTEND};
  static constexpr uint32_t extra_outputs[] = {ODO_TYPE_POINTS};
  static std::vector<odo::Parameter<OdographVo>> parameters() {
    return {odo::boolean("inertial", &OdographVo::inertial_,
                         "use accelerometer and gyroscope for motions in metres; otherwise the gyroscope alone "
                         "aids a visual odometry that is up to scale"),
            odo::real(
                "accel_bias", "m/s^2", 0.01, 2, &OdographVo::accel_bias_,
                "standard deviation of the accelerometer's bias on each axis before the first measurement (data sheets "
                "of uncalibrated sensors: 20 mg)"),
            odo::real("gyro_bias", "rad/s", 1e-4, 0.2, &OdographVo::gyro_bias_,
                      "the same of the gyroscope (data sheets: 0.5 to 1 deg/s)"),
            odo::real(
                "accel_scale", "", 1e-4, 0.1, &OdographVo::accel_scale_,
                "standard deviation of the scale of each of the accelerometer's axes, relative (data sheets: 0.4 to 1 "
                "%, calibrated in phones)"),
            odo::real("gyro_scale", "", 1e-4, 0.1, &OdographVo::gyro_scale_, "the same of the gyroscope"),
            odo::real("misalignment", "rad", 1e-4, 0.1, &OdographVo::misalignment_,
                      "standard deviation of each sensor axis against the others (data sheets: 0.3 to 1 %)"),
            odo::real("time_offset", "s", 1e-4, 0.1, &OdographVo::time_offset_,
                      "standard deviation of the camera's clock against the IMU's")};
  }

  void on(const odo_calibration& c, odo::Output& output) {
    emit_pending(true, output);
    if (camera_.take(c) || std::holds_alternative<std::monostate>(odometry_)) start();
  }

  /// The manufacturer's noise values replace the defaults from here on.
  void on(const odo_imu_noise& noise, odo::Output& output) {
    emit_pending(true, output);
    noise_ = noise;
    if (camera_.calibration()) start();
  }

  void on(const odo_imu& imu, odo::Output& output) {
    const Eigen::Vector3d gyro_b(imu.gyro_b), accel_b(imu.accel_b);
    const bool has_force = (imu.header.flags & ODO_IMU_ACCEL) != 0;
    if (!(gyro_b.norm() <= SensorRange::rate_radps && (!has_force || accel_b.norm() <= SensorRange::force_mps2)))
      throw odo::Error(ODO_E_DISCARD, "gyro_b or accel_b exceeds the range of any phone's sensor");
    if (auto* inertial = std::get_if<InertialOdometry>(&odometry_)) {
      inertial->add_imu({imu.header.t_ns, gyro_b, accel_b}, has_force);
      emit_pending(false, output);
    } else if (auto* visual = std::get_if<Odometry>(&odometry_)) {
      visual->add_gyroscope(imu.header.t_ns, q_b_c_.conjugate() * gyro_b);
    }
  }

  void on(const odo_frame& frame, odo::Output& output) {
    const odograph::CameraModel lens = camera_.lens_of(frame);
    if (frame.header.t_ns <= frame_ns_) throw odo::Error(ODO_E_DISCARD, "t_ns is not after that of the frame before");
    frame_ns_ = frame.header.t_ns;
    const bool rolls = frame.header.flags & ODO_FRAME_LINE_TIME;
    const Frame view{odograph::grey_of(frame, converted_), odograph::mask_of(frame), frame.header.t_ns,
                     odograph::seconds(rolls ? frame.line_time_ns : 0)};
    if (auto* inertial = std::get_if<InertialOdometry>(&odometry_)) {
      emit_pending(true, output);
      inertial->change_lens(lens);
      head_ = frame;
      inertial->begin(view);
      emit_pending(false, output);
    } else if (auto* visual = std::get_if<Odometry>(&odometry_)) {
      visual->change_lens(lens);
      const Motion motion = visual->process(view);
      const int64_t from_ns = std::exchange(previous_ns_, frame.header.t_ns);
      if (from_ns != INT64_MIN) {
        const odo_vo_motion event = event_of(motion, from_ns, frame);
        points_.emit(event, visual->corners(), visual->corner_sigma_rad(), lens, camera_.size(), output);
        output.emit(event);
      }
    }
  }

 private:
  /// Starts an odometry with the present calibration of camera and IMU.
  void start() {
    const odograph::vio::Camera camera = camera_at_start(*camera_.calibration());
    q_b_c_ = camera.q_b_c;
    previous_ns_ = frame_ns_ = INT64_MIN;
    if (inertial_)
      odometry_.emplace<InertialOdometry>(inertial_parameters(), camera);
    else
      odometry_.emplace<Odometry>(Odometry::Parameters{}, camera.lens);
  }

  static odograph::vio::Camera camera_at_start(const odo_calibration& c) {
    odograph::vio::Camera camera;
    camera.lens = odograph::camera_of(c);
    camera.q_b_c = odograph::rear_camera_mount();
    if (c.header.flags & ODO_CALIBRATION_EXTRINSICS) {
      camera.q_b_c = odograph::raw_quaternion(c.q_b_c);
      camera.p_b_c = Eigen::Vector3d(c.p_b_c);
    }
    camera.middle_row = 0.5 * (c.height - 1.0);
    if (c.header.flags & ODO_CALIBRATION_LINE_TIME) camera.line_time_s = odograph::seconds(c.line_time_ns);
    return camera;
  }

  InertialOdometry::Parameters inertial_parameters() const {
    InertialOdometry::Parameters parameters;
    auto& priors = parameters.filter.priors;
    priors.accel_bias_mps2 = accel_bias_, priors.gyro_bias_radps = gyro_bias_;
    priors.accel_scale = accel_scale_, priors.gyro_scale = gyro_scale_;
    priors.misalignment_rad = misalignment_, priors.time_offset_s = time_offset_;
    if (!noise_ || !(noise_->gyro_noise > 0 && noise_->accel_noise > 0)) return parameters;
    auto& n = parameters.filter.noise;
    n.gyro = noise_->gyro_noise, n.accel = noise_->accel_noise;
    n.gyro_walk = std::max(n.gyro_walk, noise_->gyro_walk);
    n.accel_walk = std::max(n.accel_walk, noise_->accel_walk);
    return parameters;
  }

  /// Reports the pending frame's motion once the IMU has reached it, or at once with `force`.
  void emit_pending(bool force, odo::Output& output) {
    auto* inertial = std::get_if<InertialOdometry>(&odometry_);
    if (!inertial) return;
    const auto motion = inertial->finish(force);
    if (!motion) return;
    auto event = event_of(motion->motion, motion->from_ns, head_);
    if (motion->metric) put_inertial(*motion, event);
    points_.emit(event, motion->corners, motion->corner_sigma_rad, inertial->lens(), camera_.size(), output);
    output.emit(event);
    if (motion->metric) emit_refined(*inertial, motion->t_ns, output);
  }

  static odo_vo_motion event_of(const Motion& motion, int64_t from_ns, const odo_frame& frame) {
    auto event = odograph::motion_event(frame, from_ns, motion.rotation_valid, motion.translation_valid, motion.tracked,
                                        motion.inliers);
    odograph::put_motion(motion.q_c0_c1, motion.p_c0_c1, 0, 0, event);
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{event.covariance} = motion.covariance;
    odograph::put_state(motion.state, motion.failure, event);
    event.scale_group = motion.scale_group;
    return event;
  }

  static void put_inertial(const InertialMotion& m, odo_vo_motion& event) {
    event.header.flags |= ODO_VO_INERTIAL | ODO_VO_METRIC;
    event.scale_sigma = m.scale_sigma;
    Eigen::Vector3d::Map(event.velocity_c1) = m.velocity_c;
    Eigen::Vector3d::Map(event.gravity_c1) = m.gravity_c;
    Eigen::Vector3d::Map(event.gyro_bias_b) = m.gyro_bias_b;
    Eigen::Vector3d::Map(event.accel_bias_b) = m.accel_bias_b;
  }

  /// Emits the refined camera calibration, once a second.
  void emit_refined(const InertialOdometry& inertial, int64_t t_ns, odo::Output& output) {
    if (t_ns - refined_ns_ < kRefinedEvery_ns || !inertial.filter()) return;
    refined_ns_ = t_ns;
    const odograph::vio::Camera& camera = inertial.filter()->state().camera;
    const odograph::CameraModel lens = inertial.lens();
    const odo_calibration& given = *camera_.calibration();
    auto c = odo::make<odo_refined>(t_ns);
    c.header.flags = ODO_REFINED_EXTRINSICS | ODO_REFINED_TIME_OFFSET | ODO_REFINED_LINE_TIME;
    c.camera = given.header.source, c.model = given.model, c.width = given.width, c.height = given.height;
    c.fx = lens.fx, c.fy = lens.fy, c.cx = lens.cx, c.cy = lens.cy;
    c.distortion_count = static_cast<uint32_t>(lens.coefficients.size());
    std::copy(lens.coefficients.begin(), lens.coefficients.end(), c.distortion);
    put_quaternion(camera.q_b_c, c.q_b_c);
    Eigen::Vector3d::Map(c.p_b_c) = camera.p_b_c;
    c.time_offset_ns = odograph::nanoseconds(camera.time_offset_s);
    c.line_time_ns = odograph::nanoseconds(camera.line_time_s);
    output.emit(c);
  }

  static constexpr odograph::vio::Priors kPriors{};
  bool inertial_ = true;
  double accel_bias_ = kPriors.accel_bias_mps2, gyro_bias_ = kPriors.gyro_bias_radps;
  double accel_scale_ = kPriors.accel_scale, gyro_scale_ = kPriors.gyro_scale;
  double misalignment_ = kPriors.misalignment_rad, time_offset_ = kPriors.time_offset_s;
  odograph::CalibratedCamera camera_;
  std::optional<odo_imu_noise> noise_;
  /// Empty before the first calibration; then as `inertial` selects. The visual odometry is up to scale.
  std::variant<std::monostate, Odometry, InertialOdometry> odometry_;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();
  cv::Mat converted_;
  odograph::PointsEvent points_;
  odo_frame head_{};  // of the pending frame; its pixels are not kept
  int64_t previous_ns_ = INT64_MIN, frame_ns_ = INT64_MIN, refined_ns_ = INT64_MIN / 2;
};

}  // namespace

ODO_PLUGIN(OdographVo)
