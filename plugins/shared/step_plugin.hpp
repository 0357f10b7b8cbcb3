// SPDX-License-Identifier: Apache-2.0
//
// Common glue of the step estimators: messages in, detection, events out. An estimator adds its length model.
#pragma once

#include <algorithm>

#include <odograph/plugin.hpp>

#include "plugins/shared/gait/gait.hpp"
#include "plugins/shared/sensor_range.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

template <class Estimator>
class StepPlugin {
 public:
  std::array<double, 3> forward_axis{0.0, 1.0, -1.0};

  static odo::Parameter<Estimator> forward_axis_parameter() {
    return {ODO_PARAMETER_REALS,
            "forward_axis",
            "",
            -1,
            1,
            "",
            "body axis in the direction of walking; the default suits a phone held upright or flat in front",
            static_cast<std::array<double, 3> Estimator::*>(&Estimator::forward_axis)};
  }

  void configured() {
    const Eigen::Vector3d axis(forward_axis.data());
    if (axis.norm() < 1e-6) throw odo::Error(ODO_E_CONFIG, "forward_axis must not be zero");
    gait_.emplace(gait::GaitSignal::Parameters{}, gait::StepDetector::Parameters{}, axis);
  }

  void on(const odo_attitude& attitude, odo::Output&) { gait_->set_attitude(odograph::raw_quaternion(attitude.q_n_b)); }

  void on(const odo_imu& imu, odo::Output& output) {
    const Eigen::Vector3d gyro_b(imu.gyro_b), accel_b(imu.accel_b);
    if (!(gyro_b.norm() <= SensorRange::rate_radps && accel_b.norm() <= SensorRange::force_mps2))
      throw odo::Error(ODO_E_DISCARD, "gyro_b or accel_b exceeds the range of any phone's sensor");
    const auto step = gait_->update(imu.header.t_ns, gyro_b, accel_b);
    const uint32_t mode = mode_of(gait_->carrying());
    if (mode != mode_) {
      auto event = odo::make<odo_motion_mode>(imu.header.t_ns);
      event.mode = mode_ = mode;
      output.emit(event);
    }
    if (!step) return;
    auto event = odo::make<odo_step>(imu.header.t_ns);
    event.t_start_ns = step->detected.t_start_ns;
    event.t_end_ns = step->detected.t_end_ns;
    event.frequency_hz = step->frequency_hz;
    event.length_m = static_cast<Estimator*>(this)->length_m(*step);
    event.sigma_m = static_cast<Estimator*>(this)->sigma_m(event.length_m);
    event.heading_rad = step->heading_rad;
    if (step->heading_valid) event.header.flags |= ODO_STEP_HEADING;
    event.mode = mode_of(step->carrying);
    event.index = count_++;
    event.header.flags |= ODO_FLAG_QUALITY;
    event.header.quality = 0.5f;
    output.emit(event);
  }

 private:
  static uint32_t mode_of(gait::Carrying carrying) {
    switch (carrying) {
      case gait::Carrying::still: return ODO_MODE_STATIC;
      case gait::Carrying::texting: return ODO_MODE_WALKING_TEXTING;
      case gait::Carrying::swinging: return ODO_MODE_WALKING_SWINGING;
      default: return ODO_MODE_UNKNOWN;
    }
  }

  std::optional<gait::Gait> gait_;
  uint32_t mode_ = ODO_MODE_UNKNOWN;
  uint32_t count_ = 0;
};

}  // namespace odograph
