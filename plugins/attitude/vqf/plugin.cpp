// SPDX-License-Identifier: Apache-2.0
#include <odograph/plugin.hpp>

#include "plugins/attitude/vqf/vqf.hpp"

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Gaps longer than this are bridged by the gyroscope's last word no more; the filter goes on as if little time passed.
constexpr double kLongestStep_s = 0.2;
/// So that the heading does not jump when the first magnetometer sample comes a little late.
constexpr int64_t kWaitForNorth_ns = 1'000'000'000;

class VqfPlugin {
 public:
  odograph::vqf::Parameters p;
  double tau_acc = 3.0, tau_mag = 9.0;
  bool magnetometer = false;
  std::array<double, 3> forward_axis{0.0, 1.0, -1.0};

  static constexpr odo::Description description{"attitude/vqf", "1.0.0",
                                                "Orientation with bias estimation after Laidig & Seel 2023 (VQF)",
                                                ODO_INTERFACE_ATTITUDE};

  static std::vector<odo::Parameter<VqfPlugin>> parameters() {
    return {odo::real("tau_acc", "s", 0.1, 60, &VqfPlugin::tau_acc,
                      "time constant of the inclination correction (Laidig & Seel 2023)"),
            odo::real("tau_mag", "s", 0.1, 600, &VqfPlugin::tau_mag,
                      "time constant of the heading correction (Laidig & Seel 2023)"),
            odo::boolean("magnetometer", &VqfPlugin::magnetometer, "refer the heading to magnetic north"),
            odo::reals("forward_axis", "", -1, 1, &VqfPlugin::forward_axis,
                       "body axis that starts out facing north; the default suits a phone held upright or flat")};
  }

  void configured() {
    p.tau_acc_s = tau_acc;
    p.tau_mag_s = tau_mag;
    filter_ = odograph::vqf::Filter(p);
    if (Vector3d(forward_axis.data()).norm() < 1e-6) throw odo::Error(ODO_E_CONFIG, "forward_axis must not be zero");
  }

  void on(const odo_imu& imu, odo::Output& output) {
    const double dt = last_ns_ == INT64_MIN ? 0.01 : static_cast<double>(imu.header.t_ns - last_ns_) * 1e-9;
    last_ns_ = imu.header.t_ns;
    if (dt <= 0) return;
    filter_.update(Vector3d(imu.gyro_b), Vector3d(imu.accel_b), std::min(dt, kLongestStep_s));
    if (!filter_.ready()) return;
    if (first_ns_ == INT64_MIN) first_ns_ = imu.header.t_ns;
    const bool wait = magnetometer && !filter_.has_heading() && imu.header.t_ns - first_ns_ < kWaitForNorth_ns;
    if (wait) return;
    // ENU to NED; without a magnetometer turned so that the start faces north.
    static const Quaterniond ned_from_enu(0.0, std::sqrt(0.5), std::sqrt(0.5), 0.0);
    const Quaterniond q_ned_b = ned_from_enu * filter_.orientation();
    if (!aligned_) {
      aligned_ = true;
      const Vector3d forward = q_ned_b * Vector3d(forward_axis.data());
      turn_ = Quaterniond(Eigen::AngleAxisd(-std::atan2(forward.y(), forward.x()), Vector3d::UnitZ()));
    }
    const Quaterniond q = filter_.has_heading() ? q_ned_b : turn_ * q_ned_b;
    auto event = odo::make<odo_attitude>(imu.header.t_ns);
    event.q_n_b[0] = q.w(), event.q_n_b[1] = q.x(), event.q_n_b[2] = q.y(), event.q_n_b[3] = q.z();
    const double tilt = filter_.inclination_sigma(), heading = filter_.heading_sigma();
    event.covariance_n[0] = event.covariance_n[4] = tilt * tilt;
    event.covariance_n[8] = heading * heading;
    Vector3d::Map(event.gyro_bias_b) = filter_.bias();
    if (filter_.has_heading()) event.header.flags |= ODO_ATTITUDE_NORTH;
    if (filter_.mag_disturbed()) event.header.flags |= ODO_ATTITUDE_MAG_DISTURBED;
    if (filter_.at_rest()) event.header.flags |= ODO_ATTITUDE_REST;
    output.emit(event);
  }

  void on(const odo_magnetometer& sample, odo::Output&) {
    if (!magnetometer) return;
    const double dt = last_mag_ns_ == INT64_MIN ? 0.02 : static_cast<double>(sample.header.t_ns - last_mag_ns_) * 1e-9;
    last_mag_ns_ = sample.header.t_ns;
    if (dt > 0) filter_.update_magnetometer(Vector3d(sample.field_b), std::min(dt, kLongestStep_s));
  }

 private:
  odograph::vqf::Filter filter_{p};
  Quaterniond turn_ = Quaterniond::Identity();
  bool aligned_ = false;
  int64_t first_ns_ = INT64_MIN;
  int64_t last_ns_ = INT64_MIN;
  int64_t last_mag_ns_ = INT64_MIN;
};

}  // namespace

ODO_PLUGIN(VqfPlugin)
