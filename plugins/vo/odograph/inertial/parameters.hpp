// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "sdk/math/gravity.hpp"

namespace odograph::vio {

/// Noise densities of an inertial sensor, as given by an Allan deviation. Errors that grow with the motion (scale
/// error, cross-axis, g-sensitivity, motion between two samples) are not part of it and are modelled as additional
/// noise proportional to acceleration and rate.
struct ImuNoise {
  double gyro = 2e-4;  ///< rad/s/sqrt(Hz); BMI270, ICM-20602: 0.7e-4 to 1.4e-4, old phones 2.4e-4
  /// rad/s^2/sqrt(Hz) and m/s^3/sqrt(Hz). An Allan deviation of a phone at rest excludes warming and gait: with the
  /// 1e-5 and 1e-4 of a data sheet the scale of phone700_W1, seed 5, was 1.6 % too long, so smaller values are not
  /// accepted. More than 5e-5 lengthens the scale of euroc_mh05.
  double gyro_walk = 3e-5;
  double accel = 3e-3;  ///< m/s^2/sqrt(Hz); the same: 1e-3 to 1.6e-3, old phones 4e-3
  double accel_walk = 3e-4;
  double gyro_by_rate = 1e-3;     ///< of the rate, 1/sqrt(Hz): 0.3 % over 0.1 s
  double accel_by_motion = 3e-3;  ///< of the acceleration, 1/sqrt(Hz): 0.7 % over 0.1 s
  /// Vibration: excess of the samples' second differences over the sensor noise, as a density. At a high sampling rate
  /// most of it lies above the bandwidth of the body's motion and averages out; this part is aliased or moves the body.
  /// euroc_mh05 at 200 Hz shows 0.07 for the force and 2.7e-3 for the rate; the integrals over 0.1 to 1 s deviate from
  /// the truth by 0.025 to 0.035 and 0.5e-4 to 2.2e-4.
  double accel_vibration_part = 0.4, gyro_vibration_part = 0.05;
  /// Rotors and engines turn at 50 to 100 Hz. A sensor sampled at no more than twice that, without an anti-aliasing
  /// filter, folds them into the band of the motion, where the second differences do not show them: every other sample
  /// of euroc_mh05 (92 Hz becomes 8 Hz) has 0.056 and deviates by 0.03 to 0.11, every fourth has 0.108 and deviates by
  /// 0.04 to 0.12; the rate has 2.1e-3 and deviates by 1.0e-3 to 3.4e-3, and 6.2e-3 and 1.3e-3 to 3.4e-3.
  double aliased_part = 1.5;
  double fast_hz = 190, slow_hz = 110;  ///< rates of the former and the latter; linear between them
  double part_of_vibration(double rate_hz, double fast_part) const {
    const double slow = std::clamp((fast_hz - rate_hz) / (fast_hz - slow_hz), 0.0, 1.0);
    return fast_part + slow * (aliased_part - fast_part);
  }
  double vibration_s = 0.5;  ///< window before a frame over which it is measured; empirical
  double gap_mps2 = 3;       ///< acceleration of a hand during a gap in the samples; empirical
};

/// Standard deviations before the first measurement.
struct Priors {
  double tilt_rad = 0.01;         ///< of gravity's direction
  double velocity_mps = 0.05;     ///< of a phone that is held still
  double gyro_bias_radps = 0.02;  ///< 1 deg/s
  /// 20 mg, the residual before calibration in data sheets of phone sensors (BMI270 20, ICM-20602 25). Some phones are
  /// not calibrated in the factory: one recorded phone had 0.6.
  double accel_bias_mps2 = 0.2;
  double gyro_scale = 5e-3, accel_scale = 3e-3;  ///< of each axis; BMI270, ICM-20602: 0.4 to 1 %, calibrated in phones
  double misalignment_rad = 3e-3;                ///< of each axis against each other; the same: 0.3 to 1 %
  double extrinsics_rad = 0.01;                  ///< of the camera in the phone
  double lever_m = 0.01;                         ///< position of the camera relative to the IMU
  double time_offset_s = 0.008;                  ///< of the camera clock against the IMU's
  double line_time_relative = 0.1;               ///< of the given row time of a rolling shutter
  double readout_s = 0.006;                      ///< of the time from the first row to the last if none is given
  double focal_relative = 0.01;                  ///< of the focal length
  double centre_px[2] = {3, 3};                  ///< of the principal point
  double distortion[2] = {0.01, 0.01};           ///< of the first two radial coefficients
};

/// Optical image stabilisation: a lens or sensor that moves against the shake of the phone. It follows the high
/// frequencies of the rotation within its travel and yields near the end, in a manner specific to each maker. The model
/// is a gain and a leak, with an error proportional to the compensation.
struct StabiliserParameters {
  double gain_sigma = 0.3;     ///< of the gain before the first measurement; gain 0: fixed lens, 1: full compensation
  double gain_walk = 0.2;      ///< proportional to the gain, 1/sqrt(s): a fixed lens stays fixed
  double leak_hz = 0.9;        ///< at small shifts; 0.5 to 0.9 in a driver for an IMX214 module
  double end_leak_hz = 13;     ///< at the end of its travel; the same
  double travel_rad = 0.0157;  ///< 0.9 degrees; 0.5 to 1.2
  double leak_sigma = 0.7, leak_change_s = 10;  ///< of the log of the leak, and its correlation time
  double drive_error = 0.25;                    ///< of its speed, relative,
  double error_s = 0.1;                         ///< correlated over this time
  /// A stabilised lens compensates most of the rotation: a gain below this by so many sigmas for so long is a fixed
  /// lens.
  double min_gain = 0.25, fixed_sigmas = 5, fixed_s = 0.5;
  double shift_sigma_px = 1;  ///< before the first measurement
  static constexpr double kTwoPi = 6.283185307179586;
  /// Leak rate at a given shift, 1/s.
  double leak(double shift_px, double focal_px) const {
    const double used = std::min(1.0, shift_px / (travel_rad * focal_px));
    return kTwoPi * (leak_hz + (end_leak_hz - leak_hz) * used * used);
  }
  /// Derivative of the leak term by the shift.
  Eigen::Vector2d leak_change(const Eigen::Vector2d& shift_px, double focal_px) const {
    const double travel_px = travel_rad * focal_px;
    if (shift_px.norm() >= travel_px) return Eigen::Vector2d::Zero();
    return 2 * kTwoPi * (end_leak_hz - leak_hz) / (travel_px * travel_px) * shift_px;
  }
};

/// Detection of standing. A person who rotates on the spot moves the phone at the rate times an arm's length.
struct StandParameters {
  double sway_mps = 0.1;  ///< of a hand, 0.03 to 0.1
  double arm_m = 0.5;
  double window_s = 0.4;    ///< over which it is evaluated
  double force_mps2 = 0.5;  ///< std of the specific force, beyond the sensor noise: a hand 0.3 to 0.45, a walk above 1
  double flow_px = 1.2;     ///< median flow of the picture beyond one rotation
  size_t min_corners = 15;  ///< needed for a decision
  int min_samples = 5;      ///< of the IMU, needed for a decision
  /// A person shuffling at 0.2 m/s passes the tests above but covers distance: in mean_s a standing hand moves by
  /// sway_m.
  double mean_s = 1.0, sway_m = 0.03;
  /// Max variance, sum of the three axes, (m/s^2)^2, for a sensor with this noise and sampling rate.
  double max_force_variance(const ImuNoise& noise, double rate_hz) const {
    return force_mps2 * force_mps2 + 3 * noise.accel * noise.accel * rate_hz;
  }
  double sigma_mps(double rate_radps) const { return std::hypot(sway_mps, arm_m * rate_radps); }
};

/// Triangulation of a track by damped Gauss-Newton (Levenberg-Marquardt).
struct TriangulationParameters {
  int iterations = 8;
  double settled = 1e-4;  ///< relative change of the sum of squares
  double damping = 1e-3;  ///< initial; divided by ten after a step that reduces the sum, multiplied by ten otherwise
  double min_inverse_depth = 1e-4;  ///< 1/m: practically at infinity
};

/// Multi-state constraint Kalman filter. Values without a source are empirical: chosen on simulated walks (`odograph
/// bench walk700`, `odograph bench vo`) and euroc_mh05.
struct FilterParameters {
  ImuNoise noise;
  Priors priors;
  StabiliserParameters stabiliser;
  StandParameters stand;
  double gravity_mps2 = kRoundedGravity_mps2;
  size_t clones = 12;                ///< poses in the window
  size_t landmarks = 40;             ///< points that are states
  size_t features = 25;              ///< max tracks per update
  size_t min_track = 3;              ///< min observations of a track
  int max_misses = 3;                ///< consecutive rejections after which a landmark is removed
  size_t landmarks_together = 20;    ///< landmarks per update: one pass over the covariance for all of them
  double gate_tail = 0.01;           ///< share of correct measurements that a gate may reject
  double farthest_m = 1e3;           ///< a landmark farther away is practically at infinity
  double min_clone_parallax_px = 1;  ///< between two clones: with less the newer one replaces the older
  double min_displacement_m = 0.15;  ///< min displacement over the window that determines its scale
  size_t min_for_noise = 5;          ///< min innovations or residuals of a frame for their median to count
  double rate_change_s = 0.008;      ///< before and after a frame, for the angular acceleration: one readout
  /// Corner noise for gating, px: initial value; then from the median of the innovations. Most corners are accurate to
  /// 0.2 px and a few, at depth edges, to 2 px: a gate that accepts these makes the scale 1 % too long (walk700_W1,
  /// seed 4).
  double gate_sigma = 1.0, min_gate_sigma = 0.3;
  double gate_sigma_s = 0.5;  ///< time constant of that
  /// Corner noise for weighting, px. The corners of one frame have correlated errors, so that it has a lower bound.
  double min_pixel_sigma = 0.5, max_pixel_sigma = 4;
  double pixel_sigma = 1.0;
  /// The quality of corners varies: at depth edges, on glass and on moving objects the residuals of a triangulated
  /// track are several times as large, and such corners made the scale 1 % too long (walk700, seeds 4 and 5). The noise
  /// of a corner is scaled by the square of the ratio of its track's rms residual to that of a typical track.
  double typical_residual_px = 0.3;  ///< initial; then the median of the latest tracks, with a lower bound of
  double min_residual_px = 0.3;      ///< this. 0.2 is as good on simulated streets, but penalises near corners on
                                     ///< euroc_mh05 (scale error 1.4 % instead of 1.0 %).
  double residual_part = 0.2;        ///< weight of the newest corner in a landmark's residual
  /// A tracked corner drifts off its point: random walk, px/sqrt(s); 0.2 on simulated streets, 0.6 on euroc_mh05.
  double corner_walk_px = 0.3;
  double rotation_jitter_rad = 2e-4;  ///< between picture and gyroscope: stabilised lens, time stamps
  double focal_walk = 1e-4;           ///< relative, 1/sqrt(s)
  /// Autofocus: relative deviation of the focal length from its mean (sigma, correlation time). Focus breathing is 0.5
  /// to 1.2 % to either side, in moves 1.5 to 10 s apart. Many phones do not report it.
  double focus_sigma = 2e-3, focus_change_s = 4;
  /// A lens is doubted once the sum of squares of focal length and principal point over their priors exceeds this (3
  /// degrees of freedom: one of 10,000 at a look): its priors become wider by this factor.
  double doubtful_chi2 = 21, doubt = 3;
  /// What is off by more is a wrong filter, not a lens: logarithm of the focal length, principal point in focal
  /// lengths. Assumed lenses are up to a tenth off, cropped pictures 0.02 (four real ones).
  double max_focal_off = 0.15, max_centre_off = 0.08;
  double centre_walk_px = 0.02;                           ///< px/sqrt(s)
  double min_parallax_rad = 0.01;                         ///< min of a track for its depth to be estimated
  double inverse_depth = 0.2, inverse_depth_sigma = 1.0;  ///< prior of a landmark without parallax, 1/m
  TriangulationParameters triangulation;
};

}  // namespace odograph::vio
