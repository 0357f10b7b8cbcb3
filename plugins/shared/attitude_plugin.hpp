// SPDX-License-Identifier: Apache-2.0
//
// Common glue of the attitude sources: samples in, one orientation out per sample. A filter works in East-North-Up.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <odograph/plugin.hpp>

#include "plugins/shared/sensor_range.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

/// `Filter` has update(gyro, accel, dt_s), update_magnetometer(field, dt_s), ready(), orientation(), bias(),
/// inclination_sigma(), heading_sigma(), has_heading(), mag_disturbed() and at_rest().
template <class Filter>
class AttitudeSource {
 public:
  AttitudeSource() = default;
  AttitudeSource(Filter filter, bool magnetometer, const std::array<double, 3>& forward_axis)
      : filter_(std::move(filter)), magnetometer_(magnetometer), forward_axis_(forward_axis.data()) {
    if (forward_axis_.norm() < 1e-6) throw odo::Error(ODO_E_CONFIG, "forward_axis must not be zero");
  }

  void on(const odo_imu& imu, odo::Output& output) {
    expect("gyro_b", imu.gyro_b, SensorRange::rate_radps);
    expect("accel_b", imu.accel_b, SensorRange::force_mps2);
    const double dt = last_ns_ == INT64_MIN ? 0.01 : seconds(imu.header.t_ns - last_ns_);
    last_ns_ = imu.header.t_ns;
    if (dt <= 0) return;
    filter_->update(Eigen::Vector3d(imu.gyro_b), Eigen::Vector3d(imu.accel_b), std::min(dt, kLongestStep_s));
    if (!filter_->ready()) return;
    if (first_ns_ == INT64_MIN) first_ns_ = imu.header.t_ns;
    const bool wait = magnetometer_ && !filter_->has_heading() && imu.header.t_ns - first_ns_ < kWaitForNorth_ns;
    if (wait) return;
    // ENU to NED; without a magnetometer rotated so that the initial heading is north.
    static const Eigen::Quaterniond ned_from_enu(0.0, std::sqrt(0.5), std::sqrt(0.5), 0.0);
    const Eigen::Quaterniond q_ned_b = ned_from_enu * filter_->orientation();
    if (!aligned_) {
      aligned_ = true;
      const Eigen::Vector3d forward = q_ned_b * forward_axis_;
      yaw_ = Eigen::Quaterniond(Eigen::AngleAxisd(-std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()));
    }
    const Eigen::Quaterniond q = filter_->has_heading() ? q_ned_b : yaw_ * q_ned_b;
    auto event = odo::make<odo_attitude>(imu.header.t_ns);
    put_quaternion(q, event.q_n_b);
    const double tilt = filter_->inclination_sigma(), heading = filter_->heading_sigma();
    event.covariance_n[0] = event.covariance_n[4] = tilt * tilt;
    event.covariance_n[8] = heading * heading;
    Eigen::Vector3d::Map(event.gyro_bias_b) = filter_->bias();
    event.header.flags = ODO_ATTITUDE_COVARIANCE | ODO_ATTITUDE_GYRO_BIAS;
    if (filter_->has_heading()) event.header.flags |= ODO_ATTITUDE_MAGNETIC_NORTH;
    if (filter_->mag_disturbed()) event.header.flags |= ODO_ATTITUDE_MAG_DISTURBED;
    if (filter_->at_rest()) event.header.flags |= ODO_ATTITUDE_REST;
    output.emit(event);
  }

  void on(const odo_magnetometer& sample) {
    if (!magnetometer_) return;
    expect("field_b", sample.field_b, SensorRange::field_t);
    const double dt = last_mag_ns_ == INT64_MIN ? 0.02 : seconds(sample.header.t_ns - last_mag_ns_);
    last_mag_ns_ = sample.header.t_ns;
    if (dt > 0) filter_->update_magnetometer(Eigen::Vector3d(sample.field_b), std::min(dt, kLongestStep_s));
  }

 private:
  static void expect(const char* field, const double* values, double most) {
    for (int i = 0; i < 3; ++i)
      if (!(std::abs(values[i]) <= most))
        throw odo::Error(ODO_E_DISCARD, std::string(field) + "[" + std::to_string(i) +
                                            "] = " + std::to_string(values[i]) + "; expected at most " +
                                            std::to_string(most) + " in magnitude");
  }

  /// The gyroscope's last rate does not bridge longer gaps: the filter then continues as if only this time had passed.
  static constexpr double kLongestStep_s = 0.2;
  /// Prevents a jump of the heading if the first magnetometer sample is a little late.
  static constexpr int64_t kWaitForNorth_ns = 1'000'000'000;

  std::optional<Filter> filter_;
  bool magnetometer_ = false;
  Eigen::Vector3d forward_axis_ = Eigen::Vector3d::UnitY();
  Eigen::Quaterniond yaw_ = Eigen::Quaterniond::Identity();
  bool aligned_ = false;
  int64_t first_ns_ = INT64_MIN;
  int64_t last_ns_ = INT64_MIN;
  int64_t last_mag_ns_ = INT64_MIN;
};

}  // namespace odograph
