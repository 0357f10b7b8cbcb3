// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace odograph::inertial {

/// Every sigma and threshold of the inertial estimator: unit, meaning, and where it comes from. "judgement" is a
/// choice, with the range in which it was seen not to matter much; "by hand" is one that was never varied; "figures"
/// are those of docs/estimator.md.
struct Parameters {
  // The IMU. An odo_imu_noise adds to the first two in quadrature and replaces the walks.
  double gyro_noise = 1e-3;        ///< rad/s/sqrt(Hz); a phone's 1e-4 to 2.4e-4 and its scale error in rotation
  double gyro_walk = 3e-5;         ///< rad/s^2/sqrt(Hz); temperature
  double gyro_bias_sigma = 0.009;  ///< rad/s at the start: 0.5 deg/s, data sheets of BMI270 and ICM-20602
  double accel_noise = 0.05;       ///< m/s^2/sqrt(Hz); white noise of 0.002 to 0.01, scale error, vibration
  double accel_walk = 1e-3;        ///< m/s^3/sqrt(Hz); judgement
  double accel_bias_sigma = 0.15;  ///< m/s^2 at the start: +-20 mg, data sheets
  double unaided_accel_noise = 2;  ///< the same, horizontally, where nothing but steps knows the velocity: they carry
  double climb_sigma_mps = 0.25;   ///< m/s up or down where steps carry: stairs lift by 0.25 to 0.35, streets by less
  double climb_s = 4;              ///< s for which that stays alike: a kerb is one step, a flight 5 to 12 s; judgement,
                                   ///< 2 to 8 s changed heights on terrain by less than a centimetre
  double unaided_after_s = 3.0;    ///< s without a camera until then; judgement
  double gap_rotation_noise = 0.7;  ///< rad/sqrt(s) where IMU samples lack: a hand turns by 30 deg/s rms
  double gap_accel_noise = 3.0;     ///< m/s^2/sqrt(Hz) there: gait
  double longest_gap_s = 0.05;      ///< s between samples that is no gap: ten at 200 Hz, two or three at 50 Hz

  double longest_transition_s = 0.1;       ///< s of IMU samples at most that the covariance takes at once; by hand
  int64_t clone_spacing_ns = 300'000'000;  ///< ns between clones: 12 reach back 3.6 s, steps are told up to 3 s late
  int64_t reaches_back_ns = 50'000'000;    ///< ns, of the newest sample to a frame whose next one has not come; by hand

  // The start.
  double start_speed_sigma_mps = 1.0;              ///< m/s: may walk already
  double start_tilt_sigma_rad = 0.03;              ///< rad, without an attitude source
  double start_heading_sigma_rad = 0.2;            ///< rad, against north, without a compass; for fixes alone
  double start_unaided_tilt_rad = 0.2;             ///< rad, without IMU samples either; by hand
  int64_t wait_for_attitude_ns = 500'000'000;      ///< ns from the first IMU sample until the start is without; by hand
  int64_t steps_tell_velocity_ns = 1'000'000'000;  ///< ns since a step, for which it tells the velocity; by hand
  double settled_velocity_mps = 0.3;               ///< m/s of sigma, below which fixes may turn the heading
  double rewind_s = 1.5;            ///< s before the first metric motion that inertia tells: an inclination of
                                    ///< 5 mrad is 6 cm then; front-ends start in 1.2 s (odograph bench vo)
  double uninformed_sigma_m = 100;  ///< m: of what the first fix does not say, and of the barometer at first

  // Visual odometry: the error of a position against the map, correlated over a time, and the map's drift.
  double vo_position_sigma_m = 0.02;      ///< m, until the window regression has measured it; 6 to 8 mm simulated,
                                          ///< 17 to 64 mm on real phones (detrended over 4 s)
  double vo_min_sigma_m = 0.01;           ///< m; a floor: pictures of a rolling shutter, time stamps
  double vo_rotation_sigma_rad = 0.003;   ///< rad against the map
  double vo_max_sigma_m = 0.2;            ///< m; a ceiling of what windows measure; by hand
  double vo_sigma_gain = 0.3;             ///< share of a window in the sigma that windows have measured; by hand
  double vo_correlation_s = 0.5;          ///< s over which both are the same error; judgement, 0.25 to 1
  double vo_drift_per_root_m = 0.01;      ///< m/sqrt(m): across the path, without scale and heading
  double vo_rotation_memory_s = 5.0;      ///< s over which its rotations are compared with the gyroscope's; judgement
  double vo_rotation_walk = 1e-3;         ///< rad/sqrt(s): 0.018 deg a frame at 10 Hz (odograph bench vo)
  double vo_scale_walk = 2e-3;            ///< 1/sqrt(m) of log-scale: 0.9 % between halves of 10 m (odograph bench vo)
  double vo_standing_scale_walk = 0.01;   ///< 1/sqrt(s) while standing: 3 % over a stop is usual
  double unstated_scale_sigma = 0.02;     ///< of log-scale, of a metric front-end whose scale_sigma is 0; judgement
  double vio_velocity_sigma_mps = 0.1;    ///< m/s, as a front-end that used inertia itself states it
  double vio_velocity_unknown_mps = 0.3;  ///< m/s of sigma, above which such a velocity is used: below, the positions
                                          ///< have told it; by hand
  double vio_velocity_now_s = 0.05;       ///< s that such a velocity may be old, the state's is the newest; by hand
  double vio_position_sigma_m = 0.005;    ///< m, of a front-end that used inertia itself, against its own path: its
                                          ///< sliding window moves from frame to frame by 2 to 4 mm
  double vio_rotation_sigma_rad = 0.001;  ///< rad, the same of its rotation: 0.4e-3 stated a frame
  double vio_rotation_walk = 1.5e-3;      ///< rad/sqrt(s) of its rotation: 3 to 50 mrad over ten minutes of six walks;
                                          ///< what is measured against the gyroscope comes on top
  double vio_start_rate_radps = 0.01;     ///< rad/s: before it has walked its rotation is the gyroscope's, less a bias
                                          ///< that it knows so badly; 4.6, 5, 10 and 17 mrad/s on four stabilised
                                          ///< phones, below 1 mrad/s without stabiliser
  double settled_gyro_bias_radps = 1.5e-3;  ///< rad/s of sigma, below which its rotation is followed; judgement
  double led_scale_sigma = 0.2;             ///< of log-scale, as such a front-end states it: above, it is an odometry
                                            ///< like others, and standing and steps speak too; judgement
  double vio_scale_walk = 2e-4;  ///< 1/sqrt(s) of a metric front-end's log-scale: 0.5 % over ten minutes; judgement
  double vio_scale_forgetting_s = 20;  ///< s: how long its scale_sigma speaks of the same error
  double min_log_scale_sigma = 1e-3;   ///< of log-scale, and
  double max_log_scale_sigma = 1;      ///< of it: what a source's word is cut to; by hand
  double scale_news = 1.02;            ///< times the information so far: less is nothing new; by hand
  double lost_confidence = 0.25;       ///< share of its information: less is a front-end that doubts its metre anew
  double doubted_scale_walk = 0.015;   ///< 1/sqrt(m) of log-scale, of one whose metre contradicts the steps: it finds
                                      ///< back within a minute, and twenty steps follow it; walks in The Hague and Linz
  double unknown_scale_sigma = 1.0;       ///< of log-scale before anything is known
  double chord_s = 0.5;                   ///< s over which positions tell a velocity: a step
  double chord_velocity_sigma_mps = 0.3;  ///< m/s of that: the gait within a step; by hand
  double walking_m = 0.5;                 ///< m in twice chord_s, above which the camera walks: half the slowest walk
  double jump_velocity_sigma_mps = 1.0;   ///< m/s: what is left of the velocity when odometry contradicts it
  int max_rejected = 3;                   ///< odometry updates in a row, until the velocity is doubted

  // Steps.
  double factor_sigma = 0.10;        ///< of the walker's log factor: ten walkers differ so (docs/accuracy.md)
  double taught_scale_sigma = 0.10;  ///< of log-scale, as a metric front-end states it: below it, which is how walkers
                                     ///< differ, steps do not move it
  double factor_steps = 200;         ///< steps over which what was learnt of a walker is forgotten: 0.01 for the root
                                     ///< of a step, and never beyond what walkers differ; judgement
  double step_own_sigma = 0.06;      ///< of a step's length, relative, own to the step: step/odograph's README
  double step_min_sigma = 0.01;      ///< of a step's length, relative: no step's word is better; by hand
  double step_usual_gain = 0.1;      ///< share of a step in the walker's usual length; by hand
  double step_correlation = 10;      ///< steps whose own error is one error, where they are compared with odometry
  double step_across_rad = 0.10;     ///< rad, direction of one step against its heading: a hand sways
  double step_velocity_sigma_mps = 10;  ///< m/s from step to step where nothing else moves the body: large, so that
                                        ///< what was expected counts for nothing against a step
  double step_loose_across_rad = 0.5;   ///< rad, the same with the phone swung or in a pocket
  double step_heading_sigma_rad = 0.3;  ///< rad between the phone's axis and the walk at the start; judgement
  double step_heading_walk = 0.02;      ///< rad for the root of a step; judgement
  double step_height_sigma_m = 0.1;     ///< m up or down in a step beside a camera: slopes of a seventh
  double stair_height_sigma_m = 0.2;    ///< m, on stairs
  int max_steps_rejected = 4;           ///< in a row, until heading, factor and (without inertia) scale are doubted
  double doubted_scale_sigma = 0.5;     ///< of log-scale then

  // Standing.
  double still_speed_mps = 0.02;     ///< m/s, a device laid down
  double standing_speed_mps = 0.08;  ///< m/s, in the hand of somebody who stands
  double still_gyro_radps = 0.002;   ///< rad/s, a gyroscope that lies still, as a measurement of its bias
  double quiet_accel_mps2 = 0.25;    ///< m/s^2 rms about its mean: below it nobody walks (a step has above 1)
  double quiet_gyro_radps = 0.35;    ///< rad/s
  double quiet_tau_s = 0.3;          ///< s, of both
  double stand_interval_s = 0.2;     ///< s between two measurements of it, together worth one a second; by hand

  // Attitude, barometer, speed.
  double attitude_interval_s = 1.0;  ///< s: nearer ones are the same error
  double gravity_interval_s = 0.2;   ///< s between two uses of a front-end's gravity, together worth one for each
                                     ///< attitude_interval_s: at once they moved the height by 2 to 4 cm
  double attitude_tilt_rad = 0.05;   ///< rad, beside a camera: 1 deg rms, but the same over many seconds
  double attitude_unaided_tilt_rad = 0.02;  ///< rad, where no camera tells the inclination
  double attitude_bias_radps = 0.005;       ///< rad/s: an attitude source's gyroscope bias, many times over the same
  double attitude_yaw_rad = 0.02;           ///< rad
  double attitude_bias_s = 60;              ///< s for which that is the same error, unless the device rests
  double north_correlation_s = 60;          ///< s: a compass in a street goes astray by as much as it says, and comes
                                            ///< back: 20 to 60 s in simulated streets (bench canyon)
  double gyro_heading_walk = 2e-4;          ///< rad/sqrt(s): an attitude without north, the same gyroscope's
  double baro_sigma_m = 0.5;                ///< m: 4 Pa of wind and 3 of noise
  double baro_correlation_s = 10.0;         ///< s over which its error is one error; judgement
  double baro_walk = 0.02;                  ///< m/sqrt(s): 20 Pa in an hour, doors
  double uninformed_speed_s = 1.0;          ///< s between two reminders of the fastest speed where nothing else speaks

  double idle_speed_mps = 0.5;  ///< m/s: without a camera and without steps
  double rest_speed_mps = 0.2;  ///< m/s, mean between the end of a step and the start of the next one, there; judgement

  // The window regression of the scale (InertialScale).
  double window_s = 4.0;              ///< s; findings measure S and N over it
  double start_window_s = 2.5;        ///< s, as long as no scale is known; judgement
  double window_spacing_s = 0.08;     ///< s between its frames: nearer ones say nothing new, and 96 shall last a window
  int window_min_frames = 12;         ///< of one with an answer: 26 degrees of freedom are left; by hand
  double window_correlation_s = 0.5;  ///< s over which the odometry's error is one error
  double window_min_relative = 0.01;  ///< of scale, common to all windows: accelerometer's scale error 0.5 to 1 %
  double start_scale_sigma = 0.15;    ///< of log-scale, at which it counts as known
  double start_inertia_sigma = 0.3;   ///< of the windows' scale, relative: above, its logarithm means nothing
  int start_min_steps = 3;            ///< before steps tell it; by hand
  double start_min_step_ratio = 3;    ///< a step on which the odometry moved so many times less than on the others, for
                                      ///< its length, is none; by hand

  // The gate: 99.9 % of good measurements pass (chi-square).
  double gate[7] = {0, 10.83, 13.82, 16.27, 18.47, 20.52, 22.46};
  double max_integrity_risk = 0.5;  ///< a fix that is wrong more often than not is none
  int max_fixes_rejected = 5;       ///< in a row: then it is the track that is wrong; judgement
  int agreed_fixes = 10;            ///< in a row, after which a front-end that has led unbroken since is believed ...
  double agreed_for_s = 90;         ///< s: ... for that long; reflections last a minute (bench canyon)
  double arc_rad = 0.05;            ///< rad: a heading that is off by more moves the track along arcs, not tangents
  double announced_jump_m = 0.05;   ///< m: smaller corrections need no event
  double announced_rotation_rad = 0.01;    ///< rad
  double reference_path_m = 5;             ///< m between two displacement references for the step estimator
  double reference_alike_m = 20;           ///< m over which the metre's error is the same one; judgement
  double reference_min_sigma = 0.01;       ///< relative: no reference is better; by hand
  int64_t fixes_rule_ns = 60'000'000'000;  ///< ns after a fix, for which it says more of the walker; judgement
  double reference_sigma = 0.03;           ///< relative: a metre less well known does not teach
  double counted_m = 0.1;                  ///< m of path: less may be the estimate's own trembling; by hand
  double gravity_mps2 = 9.81;              ///< m/s^2, 9.78 to 9.83 on Earth; the difference is bias
};

}  // namespace odograph::inertial
