// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// Orientation integrated from a gyroscope and corrected by orientation measurements: an error-state Kalman filter of
/// the rotation error (rad, in n, left perturbation) and the gyroscope bias (rad/s, in camera axes), after Sola,
/// "Quaternion kinematics for the error-state Kalman filter" (2017), with global angular errors. Orientation fixes and
/// frames without parallax make the bias observable. The accelerometer corrects the inclination at rest; in motion its
/// weight is so low that a braking car does not tilt the estimate.
class GyroAttitude {
 public:
  /// "judgement": no sweep of this value is recorded.
  struct Parameters {
    double angle_random_walk = 0.001;  ///< rad/sqrt(s): white noise of a phone's gyroscope and other rotation errors
    double bias_sigma_radps = 0.009;   ///< rad/s at the start: 0.5 deg/s, data sheets of BMI270 and ICM-20602
    double bias_walk = 3e-5;           ///< rad/s/sqrt(s); temperature
    /// rad, direction of the specific force over a frame: 20 mg accelerometer bias, engine vibration.
    double standing_sigma_rad = 0.03;
    double moving_sigma_rad = 0.5;       ///< rad, the same in motion: a car brakes with 0.5 g; judgement
    double min_camera_sigma_rad = 5e-4;  ///< rad, lower clamp for the sigma of a camera's rotation; judgement
  };

  GyroAttitude() { reset(Eigen::Quaterniond::Identity(), Eigen::Matrix3d::Identity()); }
  void reset(const Eigen::Quaterniond& q_n_c, const Eigen::Matrix3d& covariance_n);
  /// Sets the orientation and its covariance, and keeps the bias: after a gap.
  void realign(const Eigen::Quaterniond& q_n_c, const Eigen::Matrix3d& covariance_n);

  /// Propagates by the gyroscope's rotation over dt.
  void propagate(const Eigen::Quaterniond& q_c0_c1, double dt_s);
  /// Updates with the specific force at the new time, after propagate().
  void update_gravity(const Eigen::Vector3d& force_c, bool standing);
  /// Updates with the same rotation as measured by a camera (sigma of each axis, rad).
  void update_relative_rotation(const Eigen::Quaterniond& gyro_q_c0_c1, const Eigen::Quaterniond& camera_q_c0_c1,
                                double sigma_rad, double dt_s);
  /// Updates with a measured orientation error, rad in n. Returns the applied correction, or nothing, with the state
  /// unchanged, if the innovation is outside a gate in standard deviations (0: no gate).
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
};

}  // namespace odograph
