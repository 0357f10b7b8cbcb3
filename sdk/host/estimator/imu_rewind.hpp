// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "sdk/host/base/ring.hpp"
#include "sdk/host/base/rotation.hpp"

namespace odograph::inertial {

/// The newest inertial samples as they were measured, so that a pose that becomes known can be taken back in time.
class ImuRewind {
 public:
  void clear() { samples_.clear(); }
  /// rad/s and m/s^2 in b, held for dt_s.
  void add(const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b, double dt_s) {
    samples_.push({gyro_b, accel_b, dt_s});
  }
  struct Known {
    Eigen::Quaterniond q_n_b;  ///< now, level
    Eigen::Vector3d v_n;       ///< now, m/s
    Eigen::Vector3d gyro_bias_b, accel_bias_b;
    double gravity_mps2;
  };
  /// Displacement in n over the last `reach_s`, m, or over as much of it as there is.
  Eigen::Vector3d moved(Known now, double reach_s) const {
    Eigen::Vector3d moved_n = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < samples_.size() && reach_s > 0; ++i) {
      const Sample& s = samples_.back(i);
      const Eigen::Vector3d half = -0.5 * s.dt_s * (s.gyro_b - now.gyro_bias_b);
      now.q_n_b = (now.q_n_b * exp_rotation(half)).normalized();
      const Eigen::Vector3d a_n =
          now.q_n_b * Eigen::Vector3d(s.accel_b - now.accel_bias_b) + Eigen::Vector3d(0, 0, now.gravity_mps2);
      now.q_n_b = (now.q_n_b * exp_rotation(half)).normalized();
      moved_n += s.dt_s * now.v_n - 0.5 * s.dt_s * s.dt_s * a_n;
      now.v_n -= s.dt_s * a_n;
      reach_s -= s.dt_s;
    }
    return moved_n;
  }

 private:
  struct Sample {
    Eigen::Vector3d gyro_b, accel_b;
    double dt_s;
  };
  Ring<Sample, 1024> samples_;  ///< 2 s at 500 Hz
};

}  // namespace odograph::inertial
