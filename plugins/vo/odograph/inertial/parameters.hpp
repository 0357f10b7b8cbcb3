// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "sdk/math/gravity.hpp"

namespace odograph::vio {

/// Noise densities of an inertial sensor, as an Allan deviation gives them. What it leaves out, scale error, cross
/// axis, g-sensitivity and what lies between two samples, grows with the motion: it is added as noise in proportion to
/// the acceleration and the rate.
struct ImuNoise {
  double gyro = 2e-4;  ///< rad/s/sqrt(Hz); BMI270, ICM-20602: 0.7e-4 to 1.4e-4, old phones 2.4e-4
  /// rad/s^2/sqrt(Hz) and m/s^3/sqrt(Hz). An Allan deviation of a phone on a table knows no warming and no gait: with
  /// the 1e-5 and 1e-4 of a data sheet the metre of phone700_W1, seed 5, was 1.6 % too long, so that less is not
  /// believed. More than 5e-5 makes that of euroc_mh05 longer.
  double gyro_walk = 3e-5;
  double accel = 3e-3;  ///< m/s^2/sqrt(Hz); the same: 1e-3 to 1.6e-3, old phones 4e-3
  double accel_walk = 3e-4;
  double gyro_by_rate = 1e-3;     ///< of the rate, 1/sqrt(Hz): 0.3 % over 0.1 s
  double accel_by_motion = 3e-3;  ///< of the acceleration, 1/sqrt(Hz): 0.7 % over 0.1 s
  /// A vibrating body: what the samples' second differences show above the sensor's noise, as a density. Sampled fast
  /// enough, most of it lies above what moves the body and averages out; this part is aliased or moves it. Of
  /// euroc_mh05 at 200 Hz they show 0.07 of the force and 2.7e-3 of the rate; the sums over 0.1 to 1 s are off from the
  /// truth by 0.025 to 0.035 and 0.5e-4 to 2.2e-4.
  double accel_vibration_part = 0.4, gyro_vibration_part = 0.05;
  /// Rotors and engines turn at 50 to 100 Hz. A sensor that is sampled at no more than twice that without a filter
  /// folds them to where the body moves, and the second differences do not show it: every other sample of euroc_mh05
  /// (92 Hz becomes 8 Hz) has 0.056 and is off by 0.03 to 0.11, every fourth has 0.108 and is off by 0.04 to 0.12; of
  /// the rate 2.1e-3, off by 1.0e-3 to 3.4e-3, and 6.2e-3, off by 1.3e-3 to 3.4e-3.
  double aliased_part = 1.5;
  double fast_hz = 190, slow_hz = 110;  ///< rates at which the one and the other hold; in proportion between them
  double part_of_vibration(double rate_hz, double fast_part) const {
    const double slow = std::clamp((fast_hz - rate_hz) / (fast_hz - slow_hz), 0.0, 1.0);
    return fast_part + slow * (aliased_part - fast_part);
  }
  double vibration_s = 0.5;  ///< s before a frame, over which it is measured; by hand
  double gap_mps2 = 3;       ///< acceleration of a hand while samples lack; by hand
};

/// Standard deviations before the first measurement.
struct Priors {
  double tilt_rad = 0.01;         ///< of gravity's direction
  double velocity_mps = 0.05;     ///< of a phone that is held still
  double gyro_bias_radps = 0.02;  ///< 1 deg/s
  /// 20 mg, what data sheets of phones' sensors leave before calibration (BMI270 20, ICM-20602 25). Some are not
  /// calibrated in the factory: a recorded phone was off by 0.6.
  double accel_bias_mps2 = 0.2;
  double gyro_scale = 5e-3, accel_scale = 3e-3;  ///< of each axis; BMI270, ICM-20602: 0.4 to 1 %, calibrated in phones
  double misalignment_rad = 3e-3;                ///< of each axis against each other; the same: 0.3 to 1 %
  double extrinsics_rad = 0.01;                  ///< of the camera in the phone
  double lever_m = 0.01;                         ///< of the camera's place beside the IMU
  double time_offset_s = 0.008;                  ///< of the camera's clock
  double line_time_relative = 0.1;               ///< of a rolling shutter's row time that is given
  double readout_s = 0.006;                      ///< of the time between the first row and the last where none is given
  double focal_relative = 0.01;                  ///< of the focal length
  double centre_px = 3;                          ///< of the principal point
  double distortion[2] = {0.01, 0.01};           ///< of the first two radial coefficients
};

/// A lens or sensor that moves against the phone's shake. It follows the rotation's high frequencies as far as its
/// travel reaches and gives way near its end, differently for each maker: a gain and a leak stand for it, and an error
/// in proportion to what it does.
struct StabiliserParameters {
  double follow_sigma = 0.3;   ///< of the gain before the first measurement; 0 is a fixed lens, 1 takes out all
  double follow_walk = 0.2;    ///< in proportion to the gain, 1/sqrt(s): a fixed lens stays one
  double leak_hz = 0.9;        ///< where little is asked of it; 0.5 to 0.9 in a driver of an IMX214's module
  double end_leak_hz = 13;     ///< at the end of its travel; the same
  double travel_rad = 0.0157;  ///< 0.9 degrees; 0.5 to 1.2
  double leak_sigma = 0.7, leak_change_s = 10;  ///< of its logarithm, and over which time it changes
  double drive_error = 0.25;                    ///< of its speed, relative,
  double error_s = 0.1;                         ///< correlated over this time
  /// Of a stabilised lens, which takes out most: one that follows less, by so many sigmas, for so long, is a fixed one.
  double min_follow = 0.25, fixed_sigmas = 5, fixed_s = 0.5;
  double shift_sigma_px = 1;  ///< before the first measurement
  static constexpr double kTwoPi = 6.283185307179586;
  /// By how many times e it gives way in a second, where it is shifted by so much.
  double leak(double shift_px, double focal_px) const {
    const double used = std::min(1.0, shift_px / (travel_rad * focal_px));
    return kTwoPi * (leak_hz + (end_leak_hz - leak_hz) * used * used);
  }
  /// The derivative of that by the shift.
  Eigen::Vector2d leak_change(const Eigen::Vector2d& shift_px, double focal_px) const {
    const double travel_px = travel_rad * focal_px;
    if (shift_px.norm() >= travel_px) return Eigen::Vector2d::Zero();
    return 2 * kTwoPi * (end_leak_hz - leak_hz) / (travel_px * travel_px) * shift_px;
  }
};

/// What it is to stand. Who rotates on the spot carries the phone around: at the rate times an arm's length.
struct StandParameters {
  double sway_mps = 0.1;  ///< of a hand, 0.03 to 0.1
  double arm_m = 0.5;
  double window_s = 0.4;    ///< over which it is looked at
  double force_mps2 = 0.5;  ///< of the specific force, beside the sensor's noise: a hand 0.3 to 0.45, a walk above 1
  double flow_px = 1.2;     ///< of the picture, beside one rotation, median
  size_t min_corners = 15;  ///< that tell it
  int min_samples = 5;      ///< of the IMU, that tell it
  /// Who shuffles along at 0.2 m/s looks like that too, but gets somewhere: in mean_s a hand that stays moves by
  /// sway_m.
  double mean_s = 1.0, sway_m = 0.03;
  /// Of the specific force's three axes together, (m/s^2)^2, by a sensor of this noise and so many samples a second.
  double max_force_variance(const ImuNoise& noise, double rate_hz) const {
    return force_mps2 * force_mps2 + 3 * noise.accel * noise.accel * rate_hz;
  }
  double sigma_mps(double rate_radps) const { return std::hypot(sway_mps, arm_m * rate_radps); }
};

/// A point from a track, by Gauss-Newton with damping (Levenberg & Marquardt).
struct TriangulationParameters {
  int iterations = 8;
  double settled = 1e-4;  ///< relative change of the sum of squares
  double damping = 1e-3;  ///< at the start; a tenth after a step that helps, ten times after one that does not
  double min_inverse_depth = 1e-4;  ///< 1/m: as good as infinitely far
};

/// Multi-state constraint Kalman filter. What has no source named was chosen by hand on simulated walks (`odograph
/// bench walk700`, `odograph bench vo`) and euroc_mh05.
struct FilterParameters {
  ImuNoise noise;
  Priors priors;
  StabiliserParameters stabiliser;
  StandParameters stand;
  double gravity_mps2 = kRoundedGravity_mps2;
  size_t clones = 12;                ///< poses in the window
  size_t landmarks = 40;             ///< points that are states
  size_t features = 25;              ///< tracks that an update takes at most
  size_t min_track = 3;              ///< observations of a track that is used
  int max_misses = 3;                ///< refusals in a row, of a landmark that goes
  size_t landmarks_together = 20;    ///< of one update: the covariance is gone through once for all of them
  double gate_tail = 0.01;           ///< of true measurements that a gate may refuse
  double farthest_m = 1e3;           ///< a landmark farther away is as good as infinitely far
  double min_clone_parallax_px = 1;  ///< between two clones: less, and the newer one replaces the older
  double min_displacement_m = 0.15;  ///< over the window, that tells its scale
  size_t min_for_noise = 5;          ///< innovations or residuals of a frame, whose median counts
  double rate_change_s = 0.008;  ///< before and after a frame, over which the change of the rate is taken: a readout
  /// Of a followed corner, px: at the start, then as the innovations' median says. It decides what is refused. Most
  /// corners are good to 0.2 px and a few, at edges of depth, to 2 px: a gate that lets these in makes the metre 1 %
  /// too long (walk700_W1, seed 4).
  double gate_sigma = 1.0, min_gate_sigma = 0.3;
  double gate_sigma_s = 0.5;  ///< time constant of that
  /// The same as it is weighed, px. Corners of one frame err together, so that less is never believed.
  double min_pixel_sigma = 0.5, max_pixel_sigma = 4;
  double pixel_sigma = 1.0;
  /// Corners are not equally good: at edges of depth, on glass, on what moves they leave several times the residual of
  /// the others beside one point of the world, and these made the metre 1 % too long (walk700, seeds 4 and 5). The
  /// noise of a corner grows as the square of its track's residual, the root mean square, over that of a plain one.
  double plain_residual_px = 0.3;  ///< at the start; then the median of the latest tracks, but at least
  double min_residual_px = 0.3;    ///< this. 0.2 serves simulated streets as well, but takes near corners for bad ones
                                   ///< on euroc_mh05 (1.4 % of scale instead of 1.0 %).
  double residual_part = 0.2;      ///< of a landmark's newest corner in its own residual
  /// A followed corner does not stay on its point: a random walk, px/sqrt(s); 0.2 on simulated streets, 0.6 on
  /// euroc_mh05.
  double corner_walk_px = 0.3;
  double rotation_jitter_rad = 2e-4;  ///< of a picture against the gyroscope: stabilised lens, time stamps
  double focal_walk = 1e-4;           ///< relative, 1/sqrt(s)
  /// An autofocus moves the focal length about its mean, relative, and at another time is elsewhere: breathing of 0.5
  /// to 1.2 % to either side, moves 1.5 to 10 s apart. Many phones do not tell it.
  double focus_sigma = 2e-3, focus_change_s = 4;
  double centre_walk_px = 0.02;                           ///< px/sqrt(s)
  double min_parallax_rad = 0.01;                         ///< of a track whose depth is told
  double inverse_depth = 0.2, inverse_depth_sigma = 1.0;  ///< of a landmark without parallax, 1/m
  TriangulationParameters triangulation;
};

}  // namespace odograph::vio
