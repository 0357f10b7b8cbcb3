// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace odograph {

/// Inertial measurements of a phone at one time, in b; rad/s, m/s^2.
struct InertialSample {
  double t_s;
  Eigen::Vector3d gyro_b, accel_b;
};

/// Pseudo-measurement at the sample of that index: position, velocity, or both.
struct PseudoMeasurement {
  struct Vector {
    Eigen::Vector3d value_n, sigma;
  };
  size_t sample;
  std::optional<Vector> position;  ///< m
  std::optional<Vector> velocity;  ///< m/s
};

struct WalkState {
  Eigen::Quaterniond q_n_b;
  Eigen::Vector3d p_n, v_n;                   ///< m, m/s
  Eigen::Vector3d gyro_bias_b, accel_bias_b;  ///< rad/s, m/s^2
};

/// Standard deviations of the smoother. The inertial ones determine how closely the walk follows the samples; they are
/// several times a phone's data sheet values, to cover scale errors and motion between samples at 50 Hz.
struct SmootherParameters {
  double gyro_noise = 1e-3;   ///< rad/s/sqrt(Hz)
  double accel_noise = 0.02;  ///< m/s^2/sqrt(Hz)
  double gyro_walk = 3e-5;    ///< rad/s^2/sqrt(Hz)
  double accel_walk = 1e-3;   ///< m/s^3/sqrt(Hz)
  double gyro_bias = 0.005;   ///< rad/s at the start: the phone has calibrated it
  double accel_bias = 0.4;    ///< m/s^2 at the start: 40 mg (BMI160); the two phones of the 80 walks have 0.3 and 0.5
  double start_m = 5.0;       ///< of the initial guess of the first sample
  double start_mps = 2.0;     ///< the same
  double tilt_rad = 0.05;     ///< of the initial guess of the first sample; later guesses are not used
  double heading_rad = 0.5;   ///< the same: a magnetometer indoors
  int iterations = 6;         ///< Gauss-Newton; four suffice on the 80 walks
};

/// Maximum a posteriori motion given the inertial samples and the pseudo-measurements: an iterated extended
/// Rauch-Tung-Striebel smoother over orientation (left error), position, velocity and both biases (Bell 1994:
/// equivalent to Gauss-Newton on the whole walk). `start` is the initial guess, one state per sample. Returns the
/// improved states.
std::vector<WalkState> smooth_walk(const std::vector<InertialSample>& samples,
                                   const std::vector<PseudoMeasurement>& measurements, std::vector<WalkState> start,
                                   const SmootherParameters& parameters = {});

}  // namespace odograph
