// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "plugins/vo/odograph/inertial/filter.hpp"

namespace odograph::vio {

/// A frame before the metre is known: its corners, and the visual odometry's pose, up to scale.
struct StartFrame {
  FrameCorners corners;
  Eigen::Isometry3d T_w_c = Eigen::Isometry3d::Identity();
  bool posed = false;  ///< the pose is one of the present map's
  unsigned group = 0;  ///< poses of one group share their scale
};

/// "By hand": chosen on simulated walks (`odograph bench walk700`, phone scenarios) and euroc_mh05; no sweep is
/// recorded.
struct StartParameters {
  // Still.
  /// Of a phone that is held still, before the filter starts from it. A swing has half a second at its turning points,
  /// a second has none (tests); but a drive's fixes are lost while it waits a second, so it is 0.6.
  double still_s = 0.6;
  int still_looks = 4;             ///< pictures of that time, all of which a rotation alone must explain; by hand
  double still_tilt_rad = 0.1;     ///< before gravity is measured
  double still_rate_radps = 0.05;  ///< below this the mean rate is the gyroscope's bias; by hand
  double still_bias_sigma_radps = 0.005;  ///< which is then so well known; by hand
  double still_arm_mps = 0.15;            ///< speed of a phone that somebody who rotates carries around; by hand
  double still_px = 1.5;                  ///< of the picture's flow that a rotation leaves over; by hand
  double still_gravity_sigmas = 3;        ///< of the accelerometer bias, by which the force may differ from gravity
  int still_samples = 10;                 ///< of the IMU, at least
  // In motion: the visual odometry's poses aligned with the IMU.
  double min_flow_px = 1;          ///< that a rotation leaves over: a hand that stands has 0.2 to 0.7
  double min_s = 0.8, max_s = 3;   ///< of motion that is looked at; by hand
  size_t min_frames = 6;           ///< 18 equations for 12 unknowns
  int alignment_iterations = 4;    ///< of the noise and of gravity's direction, about which it is linearised
  double min_visual_sigma = 2e-3;  ///< of a visual position, of the map's scale (median depth one): 1 px; by hand
  double alignment_sigma = 0.35;   ///< relative, of the metre by the visual poses: more is no start; by hand
  double max_rms_m = 0.1;          ///< that the visual poses leave beside the inertial ones: 0.01 where they are good
  double scale_sigma = 0.15;       ///< relative, of the metre that the filter leaves: more is no start; by hand
  double max_bias_sigmas = 5;      ///< of the accelerometer's bias, by its prior
  double min_fit = 0.5;            ///< share of the tracks that the filter accepts over those frames; by hand
  size_t min_common = 8;           ///< landmarks by which two starts are compared; by hand
  /// Filter::camera_pull, squares of sigmas. Chosen on phone_house alone, whose lens is guessed 7 % off and needs 23.
  double max_camera_pull = 25;
  double max_gate_px = 1.5;  ///< of the corners' noise as the filter finds it: more, and it is the start that is wrong
  /// Of the velocity's change over the last history_s, of which a start in motion knows the end alone: who starts to
  /// walk changes it by 1.4 m/s, to run by 3.
  double velocity_change_mps = 1.5, history_s = 3;
  int passes = 3;                    ///< of the filter over those frames, each linearised about the one before
  double velocity_sigma_mps = 0.15;  ///< of the filter that starts, beside the scale's alignment_sigma; by hand
};

/// The inertial alignment of a piece of visual odometry: p_visual = a + b t + c t^2 / 2 + d (inertial displacement),
/// |c| = d g. The inertial side has next to no noise over two seconds and the visual side has, so that the regression
/// is of the visual poses on the inertial ones: the other way round the metre would come out too small (errors in
/// variables).
struct Alignment {
  Navigation nav;             ///< at the first frame, in a w whose z is along gravity
  double scale = 0;           ///< of the visual odometry
  double relative_sigma = 0;  ///< of it
  double tilt_rad = 0;        ///< standard deviation of gravity's direction
  double rms_m = 0;           ///< of what is left over
};
std::optional<Alignment> align_with_imu(const std::deque<StartFrame>& frames, size_t from, const ImuBuffer& imu,
                                        const Camera& camera, const Eigen::Vector3d& gyro_bias,
                                        const FilterParameters& p, const StartParameters& s);

/// Tries to start a filter from the latest frames: still, or in motion. Nothing where the metre is not told yet.
std::optional<Filter> start_still(const std::deque<StartFrame>& frames, const ImuBuffer& imu, const Camera& camera,
                                  const FilterParameters& p, const StartParameters& s);
std::optional<Filter> start_moving(const std::deque<StartFrame>& frames, const ImuBuffer& imu, const Camera& camera,
                                   const Eigen::Vector3d& gyro_bias, const FilterParameters& p,
                                   const StartParameters& s);

/// How many times as large the second filter has the world, by the median depth of the landmarks that both have in the
/// newest frame of which both have a clone. Nothing where these are fewer than `least`.
std::optional<double> scale_between(const State& first, const State& second, size_t least);

}  // namespace odograph::vio
