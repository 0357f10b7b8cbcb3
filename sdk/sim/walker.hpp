// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "sdk/recording/trajectory.hpp"
#include "sdk/sim/scenario.hpp"

namespace odograph {

/// The simulated walk in closed form: pose of the phone's body (x right, y up, z out of the screen) in n at any time.
/// The path is straight, turns on an arc and goes straight again; walking starts and ends smoothly. The hand bobs with
/// each step (lowest at the foot's contact), sways with each stride and trembles. Shares nothing with any estimator.
class Walker {
 public:
  Walker(const Scenario& scenario, uint64_t seed);

  Eigen::Isometry3d pose(double t_s) const;  ///< T_n_b
  double duration_s() const { return duration_s_; }

  struct Kinematics {
    Eigen::Vector3d angular_velocity_b;  ///< rad/s
    Eigen::Vector3d specific_force_b;    ///< m/s^2
  };
  /// By differences of the closed form over 2 ms: what an ideal IMU measures.
  Kinematics kinematics(double t_s) const;

  struct Step {
    double t_start_s, t_end_s, length_m;
  };
  const std::vector<Step>& steps() const { return steps_; }

 private:
  double arc_length(double t_s) const;
  double vigour(double t_s) const;  ///< 0 standing, 1 walking
  double step_phase(double t_s) const;
  void path(double s, Eigen::Vector2d& north_east, double& heading) const;

  Scenario c_;
  double ramp_s_ = 1.0;
  double walk_s_ = 0.0;
  double duration_s_ = 0.0;
  double tremor_phase_[6] = {};
  double stride_asymmetry_ = 0.02;
  std::vector<Step> steps_;
};

}  // namespace odograph
