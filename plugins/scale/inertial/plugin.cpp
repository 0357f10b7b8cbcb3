// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <utility>

#include "plugins/scale/inertial/inertial_scale.hpp"
#include "plugins/shared/horizontal_scale.hpp"
#include "sdk/math/rotation.hpp"
#include "plugins/shared/sensor_range.hpp"

namespace {

/// Scale of a scale group from the IMU, for a front-end that does not use the IMU.
class Inertial {
 public:
  double window = 4, start_sigma = 0.15, scale_walk = 0.03, common_sigma = 0.03;

  static constexpr odo::Description description{"scale/inertial", "1.0.0",
                                                "Scale from the IMU, for a front-end that does not use the IMU",
                                                ODO_INTERFACE_SCALE_SOURCE};
  static std::vector<odo::Parameter<Inertial>> parameters() {
    return {odo::real("window", "s", 2, 10, &Inertial::window, "duration of motion in one regression"),
            odo::real("start_sigma", "", 0.01, 0.5, &Inertial::start_sigma,
                      "relative standard deviation of the scale below which it is first emitted"),
            odo::real("scale_walk", "", 0, 1, &Inertial::scale_walk,
                      "relative change of the odometry's scale over 1 m; over d metres sqrt(d) times that"),
            odo::real("common_sigma", "", 0.01, 0.2, &Inertial::common_sigma,
                      "relative standard deviation common to all windows: accelerometer, rolling shutter")};
  }
  void configured() {
    odograph::inertial_scale::Parameters p;
    p.window_s = window, p.start_sigma = start_sigma, p.scale_walk = scale_walk, p.common_sigma = common_sigma;
    scale_ = odograph::inertial_scale::InertialScale(p);
  }

  void on(const odo_calibration& c, odo::Output&) {
    mounts_.erase(c.header.source);
    if ((c.header.flags & ODO_CALIBRATION_EXTRINSICS) != 0)
      mounts_[c.header.source] = {odograph::raw_quaternion(c.q_b_c), Eigen::Vector3d(c.p_b_c)};
  }

  void on(const odo_imu& imu, odo::Output&) {
    constexpr uint32_t needed = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    if ((imu.header.flags & needed) != needed) return;
    const Eigen::Vector3d gyro_b(imu.gyro_b), accel_b(imu.accel_b);
    if (!(gyro_b.norm() <= odograph::SensorRange::rate_radps && accel_b.norm() <= odograph::SensorRange::force_mps2))
      throw odo::Error(ODO_E_DISCARD, "gyro_b or accel_b exceeds the range of any phone's sensor");
    scale_.add_imu(imu.header.t_ns, gyro_b, accel_b);
  }

  void on(const odo_vo_motion& motion, odo::Output& output) {
    if ((motion.header.flags & ODO_VO_METRIC) != 0) {
      if (!std::exchange(reported_, true))
        output.report(ODO_SEVERITY_INFO, "metric", "the odometry is metric: no scale is computed");
      return;
    }
    const Eigen::Vector3d p_c0_c1(motion.p_c0_c1);
    const bool translates =
        odograph::scalable(motion) && (motion.header.flags & ODO_VO_ROTATION) != 0 && motion.state != ODO_LOST;
    if (translates && !(p_c0_c1.norm() < kMaxDisplacement))
      throw odo::Error(ODO_E_DISCARD, "p_c0_c1 is out of range for a motion between two frames");
    if (const auto mount = mounts_.find(motion.camera); mount != mounts_.end()) scale_.set_camera(mount->second);
    scale_.add_motion({motion.t_from_ns, motion.header.t_ns, odograph::raw_quaternion(motion.q_n_c0),
                       odograph::raw_quaternion(motion.q_c0_c1), p_c0_c1, motion.scale_group, translates});
    const auto found = scale_.scale();
    if (!translates || !found) return;
    auto scale = odograph::scale_of(motion);
    scale.scale = found->scale;
    scale.sigma = found->scale * found->relative_sigma;
    scale.displacement_m = found->scale * p_c0_c1.norm();
    scale.header.flags = ODO_SCALE_NOT_BY_STEPS | ODO_SCALE_STEADY;
    output.emit(scale);
  }

 private:
  static constexpr double kMaxDisplacement = 1e9;  // up to scale; larger values would stay in the sums forever
  odograph::inertial_scale::InertialScale scale_;
  std::map<uint32_t, odograph::inertial_scale::Mount> mounts_;  // of each camera
  bool reported_ = false;
};

}  // namespace

ODO_PLUGIN(Inertial)
