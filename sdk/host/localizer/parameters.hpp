// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace odograph {

/// Every sigma and threshold of the localizer: unit, meaning, source. "judgement" is a choice with the range in which it
/// was seen not to matter much; "by hand" was never varied. Equations are those of docs/estimator.md.
struct LocalizerParameters {
  // The track of a front-end.
  double drift_per_root_m = 0.01;      ///< m/sqrt(m), each axis, without scale and heading (odograph bench vo)
  double height_drift_per_root_m = 0.03;  ///< m/sqrt(m) of it downwards: an inclination of 5 mrad for 40 m
  double rotation_walk = 1e-3;         ///< rad/sqrt(s) of its heading: 0.018 deg a frame at 10 Hz (odograph bench vo)
  double inertial_rotation_walk = 1.5e-3;  ///< the same with inertia: 3 to 50 mrad over ten minutes of six walks
  double rotation_off_rad = 0.015;     ///< rad from the gyroscope's, above which a front-end's rotation is no rotation of
                                       ///< the phone; stabilised lenses differ by 2 to 3 mrad; by hand
  double rotation_off_share = 0.05;    ///< of the rotation: the gyroscope's scale error, rolling shutter; by hand
  double start_rate_radps = 0.01;      ///< rad/s: gyroscope bias of a front-end with inertia before it has walked;
                                       ///< 4.6 to 17 mrad/s on four stabilised phones, below 1 without a stabiliser
  double walked_scale_sigma = 0.10;    ///< of log-scale: below it such a front-end has walked, and knows the metric
                                       ///< scale better than walkers differ, so that steps do not move it
  double tilt_time_s = 10;             ///< s over which the attitude levels a front-end without inertia; judgement
  double tilt_sigma_rad = 0.01;        ///< rad of the inclination that it states
  double rewind_s = 1.5;               ///< s before the first metric motion that inertia covers: an inclination of 5 mrad
                                       ///< is 6 cm then; front-ends start in 1.2 s (odograph bench vo)
  double rewind_sigma_mps = 0.1;       ///< m/s of the velocity that is rewound
  double impossible = 5;               ///< times coupling.fastest: a motion that picture or scale got wrong; by hand
  double silent_s = 1.0;               ///< s without a translation, until steps carry; they are told 0.4 s late
  double silent_start_s = 6.0;         ///< s after the first frame of a camera that has never moved
  double idle_speed_mps = 0.5;         ///< m/s that nobody has seen, where steps would be told; by hand

  // Scale.
  double unknown_scale_sigma = 1.0;    ///< of log-scale before anything is known
  double known_scale_sigma = 0.15;     ///< of log-scale, at which it counts as known
  double unstated_scale_sigma = 0.02;  ///< of a metric front-end that states none; judgement
  double min_scale_sigma = 1e-3;       ///< lower clamp of a stated sigma; by hand
  double max_scale_sigma = 1;          ///< upper clamp; by hand
  double lost_confidence = 0.25;       ///< share of its information below which a front-end has doubted its scale anew
  double metric_scale_walk = 2e-4;     ///< 1/sqrt(s) of a metric front-end: 0.5 % over ten minutes; judgement
  double scale_walk = 2e-3;            ///< 1/sqrt(m) of another: 0.9 % between halves of 10 m (odograph bench vo)
  double doubted_scale_walk = 0.015;   ///< 1/sqrt(m) of one whose scale contradicts the steps
  double scale_memory_s = 20;          ///< s for which a scale source repeats the same error
  double lead_scale_sigma = 0.2;       ///< of log-scale: above, a front-end with inertia does not outweigh fixes
  double walking_m = 0.5;              ///< m a second, above which the camera walks: half the slowest walk

  // Steps.
  double factor_sigma = 0.10;          ///< of the walker's log factor: ten walkers differ so (docs/accuracy.md)
  double factor_steps = 200;           ///< steps over which what was learnt of a walker is forgotten; judgement
  double step_own_sigma = 0.06;        ///< of a step's length, relative, its own: step/odograph's README
  double step_correlation = 10;        ///< steps whose own error is one error, beside odometry
  double step_across_rad = 0.10;       ///< rad of one step's direction: a hand sways
  double step_loose_across_rad = 0.5;  ///< rad, the same with the phone swung or in a pocket
  double step_heading_sigma_rad = 0.3; ///< rad between the phone's axis and the walk at the start; judgement
  double step_heading_walk = 0.02;     ///< rad for the root of a step; judgement
  int max_steps_rejected = 4;          ///< in a row, until heading and factor are doubted
  double climb_sigma_mps = 0.25;       ///< m/s up or down where steps carry: stairs lift by 0.25 to 0.35
  double climb_s = 4;                  ///< s for which that stays alike: a flight takes 5 to 12 s; judgement, 2 to 8

  // Heading, height.
  double attitude_interval_s = 1.0;    ///< s between attitudes that are used: nearer ones have the same error
  double attitude_yaw_rad = 0.02;      ///< rad of one
  double attitude_walk = 2e-4;         ///< rad/sqrt(s) of a heading without north
  double attitude_gap_s = 0.25;        ///< s without an attitude, after which its frame may have turned; by hand
  double gap_turn = 0.7;               ///< rad/sqrt(s) by which: a hand turns by 30 deg/s rms
  double north_correlation_s = 60;     ///< s for which a compass errs alike: 20 to 60 s in streets (bench canyon)
  double heading_rate_radps = 0.009;   ///< rad/s of a gyroscope chain at the start: 0.5 deg/s, BMI270, ICM-20602
  double heading_rate_walk = 3e-5;     ///< rad/s/sqrt(s); temperature
  double baro_sigma_m = 0.5;           ///< m: 4 Pa of wind and 3 of noise
  double baro_correlation_s = 10;      ///< s over which its error is one error; judgement
  double baro_walk = 0.02;             ///< m/sqrt(s): 20 Pa in an hour, doors

  // Fixes. The gate of other measurements lets 99.9 % of good ones pass (chi-square).
  double gate[5] = {0, 10.83, 13.82, 16.27, 18.47};
  double start_heading_rad = 0.2;      ///< rad against north without a compass; opened by the first fix
  double any_heading_rad = 1.8;        ///< rad: uniform over the circle, pi / sqrt(3)
  double max_integrity_risk = 0.5;     ///< a fix that is wrong more often than not is none
  int max_fixes_rejected = 5;          ///< in a row: then the track is wrong; judgement
  int agreed_fixes = 10;               ///< in a row, after which a front-end that leads is believed instead ...
  double agreed_for_s = 90;            ///< s: ... for that long; reflections last a minute (bench canyon)
  double arc_rad = 0.05;               ///< rad: a heading that is off by more turns the track first

  // Output.
  double announced_jump_m = 0.05;      ///< m: smaller corrections are no event
  double announced_rotation_rad = 0.01;  ///< rad
  double counted_m = 0.1;              ///< m of path: less may be trembling; by hand
};

}  // namespace odograph
