// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "plugins/vo/odograph/inertial/lens.hpp"

namespace odograph::vio {

/// Frames: w has z along gravity and any heading; b is the IMU's; c the camera's.
/// Perturbations are on the side of w (right-invariant error): R = Exp(theta) R_est, p = Exp(theta) p_est + rho,
/// v = Exp(theta) v_est + nu; biases and camera parameters are additive. The unobservable directions, global heading
/// and position, are then independent of the estimate (Barrau & Bonnabel 2015), so that linearisation yields no
/// spurious information about them.
struct Navigation {
  Eigen::Quaterniond q_w_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d v_w = Eigen::Vector3d::Zero(), p_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), accel_bias = Eigen::Vector3d::Zero();
  /// Scale and misalignment of the sensor axes. The common scale of the accelerometer axes equals the metric scale,
  /// which is unobservable here; the rest matters: it projects the rise and fall of a walk forward, at the step
  /// frequency.
  Eigen::Matrix3d gyro_axes = Eigen::Matrix3d::Identity(), accel_axes = Eigen::Matrix3d::Identity();

  Eigen::Vector3d rate(const Eigen::Vector3d& measured_b) const { return gyro_axes * (measured_b - gyro_bias); }
  Eigen::Vector3d force(const Eigen::Vector3d& measured_b) const { return accel_axes * (measured_b - accel_bias); }
};

/// The camera with its online calibration.
struct Camera {
  CameraModel lens;
  Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity();  ///< R_b_c = Exp(phi) R_est
  Eigen::Vector3d p_b_c = Eigen::Vector3d::Zero();
  double time_offset_s = 0;  ///< IMU time = frame time + this
  double line_time_s = 0;
  double middle_row = 0;
  /// A stabilised lens shifts the picture against the shake of the phone: s' = gain f (w_y, -w_x) - e^leak L(s) s,
  /// with w the rate in c and L as in StabiliserParameters.
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  double gain = 0;   ///< gain; 0: fixed lens, 1: full compensation
  double leak = 0;   ///< log of the factor on the leak
  double focus = 0;  ///< log of the present focal length over the lens's, moved by autofocus

  double focal_px() const { return lens.focal() * std::exp(focus); }
};

/// Pose of the camera at the middle row of a frame, with the motion during the readout.
struct Clone {
  uint32_t id = 0;
  int64_t frame_ns = 0;
  Eigen::Quaterniond q_w_c = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_c = Eigen::Vector3d::Zero(), rate_change_c = Eigen::Vector3d::Zero();  ///< rad/s, rad/s^2
  Eigen::Vector3d v_w = Eigen::Vector3d::Zero(), a_w = Eigen::Vector3d::Zero();
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero(), shift_rate_px_s = Eigen::Vector2d::Zero();
  Eigen::Vector2d drive_px_s = Eigen::Vector2d::Zero();  ///< rate of the shift at full compensation
  double focal_px = 0;                                   ///< includes autofocus
};

/// A point in its anchor: x/z, y/z and 1/z in the camera at the anchor's middle row.
struct Landmark {
  uint64_t track = 0;
  uint32_t anchor = 0;  ///< id of the clone
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  int misses = 0;
  double rms_px = 0;  ///< residual of its corners
};

/// First index of each block.
namespace block {
inline constexpr int theta = 0, nu = 3, rho = 6, gyro_bias = 9, accel_bias = 12, navigation = 15;
inline constexpr int gyro_axes = 15, accel_axes = 24, axes = 18;  // column-major; axes: of both sensors
inline constexpr int extrinsics = 33, lever = 36, time_offset = 39, line_time = 40, lens = 41;
inline constexpr int shift = 46, gain = 48, leak = 49, focus = 50;
/// Error of the common scale of all lengths in the map, without a state of its own: v = e^s Exp(theta) v_est + nu,
/// likewise positions, and inverse depths by e^-s. No picture depends on it, exactly. Without it a scale sigma of 15 %
/// leaves second-order residuals that act as spurious information about the scale and make it too long.
inline constexpr int scale = 51, fixed = 52;
inline constexpr int clone = 9, clone_shift = 6, clone_focal = 8;  // theta, rho, shift, log of the focal length
}  // namespace block

struct State {
  int64_t t_ns = 0;  ///< IMU time
  Navigation nav;
  Camera camera;
  std::vector<Clone> clones;  ///< oldest first
  std::vector<Landmark> landmarks;
  Eigen::MatrixXd P;  ///< in the order of block, then clones, then landmarks

  int size() const { return landmark_at(landmarks.size()); }
  int clone_at(size_t i) const { return block::fixed + block::clone * static_cast<int>(i); }
  int landmark_at(size_t j) const { return clone_at(clones.size()) + 3 * static_cast<int>(j); }
  /// Index of a clone, or clones.size().
  size_t find_clone(uint32_t id) const;
  Eigen::Vector3d point(const Landmark& landmark) const;  ///< in w

  void correct(const Eigen::VectorXd& delta);
  /// Replaces the prior of a variable, of standard deviation `sigma`, by one that is `factor` times as wide, as if it
  /// had been so from the beginning. `deviation`: of the estimate from the prior's mean.
  void weaken_prior(int variable, double deviation, double sigma, double factor);
  /// Appends a clone whose error is J times the present error, plus noise.
  using CloneMatrix = Eigen::Matrix<double, block::clone, block::clone>;
  void add_clone(const Clone& clone, const Eigen::Matrix<double, block::clone, block::fixed>& J,
                 const CloneMatrix& noise);
  void add_landmark(const Landmark& landmark, const Eigen::MatrixXd& cross, const Eigen::Matrix3d& covariance);
  void remove_clone(size_t i);
  void remove_landmark(size_t j);
  /// Moves a landmark to another anchor.
  void move_anchor(size_t j, size_t clone);

 private:
  void remove(int from, int count);
};

/// Ray of a landmark in its anchor: (x, y, 1).
Eigen::Vector3d landmark_ray(const Eigen::Vector3d& at);
/// Derivative of (x, y, 1) / rho.
Eigen::Matrix3d landmark_jacobian(const Eigen::Vector3d& at);

}  // namespace odograph::vio
