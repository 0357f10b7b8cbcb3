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
  unsigned group = 0;  ///< poses of one group share their unit
};

struct StartParameters {
  double still_s = 0.5;              ///< of a phone that is held still, before the filter starts from it
  double still_rate_radps = 0.05;    ///< below this the mean rate is the gyroscope's bias
  double still_arm_mps = 0.15;       ///< speed of a phone that somebody who turns carries around
  double still_px = 1.5;             ///< of the picture's flow that a rotation leaves over
  double least_flow_px = 1;          ///< that it leaves over of a start in motion: a hand that stands has 0.2 to 0.7
  double least_s = 0.8, most_s = 3;  ///< of motion that a start in motion looks at
  double alignment_sigma = 0.35;     ///< relative, of the metre by the visual poses: more is no start
  double most_rms_m = 0.1;           ///< that the visual poses leave beside the inertial ones: 0.01 where they are good
  double scale_sigma = 0.15;         ///< relative, of the metre that the filter leaves: more is no start
  double most_accel_bias_mps2 = 0.8;
  double most_camera_pull = 10;  ///< Filter::camera_pull, of five degrees of freedom
  double most_gate_px = 1.5;  ///< of the corners' noise as the filter finds it: more, and it is the start that is wrong
  /// Of the velocity's change over the last history_s, of which a start in motion knows the end alone: who starts to
  /// walk changes it by 1.4 m/s, to run by 3.
  double velocity_change_mps = 1.5, history_s = 3;
  int passes = 3;
};

/// The inertial alignment of a piece of visual odometry: p_visual = a + b t + c t^2 / 2 + d (inertial displacement),
/// |c| = d g. The inertial side has next to no noise over two seconds and the visual side has, so that the regression
/// is of the visual poses on the inertial ones: the other way round the metre would come out too small (errors in
/// variables).
struct Alignment {
  Navigation nav;  ///< at the first frame, in a w whose z is along gravity
  double metres_per_unit = 0;
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

}  // namespace odograph::vio
