// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/math/ring.hpp"

namespace odograph {

/// Orientation chained from a gyroscope's rotations, corrected by whatever sees the orientation: an error-state Kalman
/// filter of the rotation's error (rad, in n, on the left) and of the gyroscope's bias (rad/s, in the camera's axes),
/// after Sola, "Quaternion kinematics for the error-state Kalman filter" (2017), with global angular errors. The bias
/// is learnt from fixes of the orientation and from pictures without parallax. The accelerometer counts where the
/// carrier stands; in motion so little that a car's braking does not tilt the world.
class GyroAttitudeFilter {
 public:
  /// "judgement": a choice of which no sweep is recorded.
  struct Parameters {
    double angle_random_walk = 0.001;  ///< rad/sqrt(s): white noise of a phone's gyroscope, and what else rotates it
    double bias_sigma_radps = 0.009;   ///< rad/s at the start: 0.5 deg/s, data sheets of BMI270 and ICM-20602
    double bias_walk = 3e-5;           ///< rad/s/sqrt(s); temperature
    double standing_sigma_rad = 0.03;  ///< rad, of the force's direction over a frame: an accelerometer's bias of
                                       ///< 20 mg, an engine
    double moving_sigma_rad = 0.5;     ///< rad, the same in motion: a car brakes with 0.5 g; judgement
    double longest_gap_s = 0.05;       ///< s between samples that is no gap: ten at 200 Hz, two or three at 50 Hz
    double min_seen_sigma_rad = 5e-4;  ///< rad, of a camera's rotation: never believed to be better; judgement
  };

  GyroAttitudeFilter() { reset(Eigen::Quaterniond::Identity(), Eigen::Matrix3d::Identity()); }
  void reset(const Eigen::Quaterniond& q_n_c, const Eigen::Matrix3d& covariance_n);

  /// Keeps a whole IMU sample for intervals to come. Times increase.
  void add_imu(const odo_imu& imu) { samples_.push(imu); }

  /// What the IMU said between two times, in the camera's axes.
  struct Interval {
    Eigen::Quaterniond q_c0_c1;  ///< the gyroscope's rotation as it came
    Eigen::Vector3d force_c;     ///< mean specific force, m/s^2, in the axes at the end
    double dt_s;
  };
  /// Nothing where samples lack.
  std::optional<Interval> between(int64_t from_ns, int64_t to_ns, const Eigen::Quaterniond& q_b_c) const;

  /// The gyroscope's rotation over dt.
  void propagate(const Eigen::Quaterniond& q_c0_c1, double dt_s);
  /// The specific force seen then, after propagate().
  void update_gravity(const Eigen::Vector3d& force_c, bool standing);
  /// The same rotation, seen by a camera (rad, standard deviation of each axis).
  void update_relative_rotation(const Eigen::Quaterniond& gyro_q_c0_c1, const Eigen::Quaterniond& seen_q_c0_c1,
                                double sigma_rad, double dt_s);
  /// The orientation was off by this rotation, rad in n; false, and nothing changed, outside a gate (0: none) of
  /// standard deviations. Returns what it rotated by.
  std::optional<Eigen::Vector3d> correct(const Eigen::Vector3d& off_n, const Eigen::Matrix3d& covariance_n,
                                         double gate_sigma);

  const Eigen::Quaterniond& q_n_c() const { return q_n_c_; }
  Eigen::Matrix3d covariance_n() const { return P_.topLeftCorner<3, 3>(); }
  const Eigen::Vector3d& bias_c() const { return bias_c_; }

 private:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  Eigen::Vector3d apply(const Vector6d& error);

  Parameters p_;
  Eigen::Quaterniond q_n_c_;
  Eigen::Vector3d bias_c_;
  Matrix6d P_;
  Ring<odo_imu, 1024> samples_;
};

}  // namespace odograph
