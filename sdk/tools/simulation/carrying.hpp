// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "sdk/tools/simulation/signal.hpp"

namespace odograph {

/// Pose of a phone on the trunk: position relative to the trunk's base (forward, right, down) and rotations about these
/// axes from an upright phone's attitude.
struct CarriedPose {
  Eigen::Vector3d offset;
  double pitch_rad, roll_rad;
};

/// On the front of a thigh, in a trouser pocket or a holster. The thigh swings about the hip once per stride about a
/// mean flexion; flexion is faster than extension (total hip angle 40 degrees: Winter, Biomechanics and Motor Control
/// of Human Movement, 2009). `phase`: integers at foot contacts. `vigour`: of the gait, 1 at the usual step.
CarriedPose on_leg(double phase, double vigour, double height_m);

/// In a bag on a strap: a damped pendulum about a shoulder that moves with the trunk. Strap angles, forward and to the
/// right, for each sample of the trunk's position in n, m.
struct Bag {
  Bag(const std::vector<Eigen::Vector3d>& trunk_n, const Signal& heading_rad, double length_m, double damping,
      double rate_hz);
  CarriedPose at(size_t sample, double height_m) const;

  double strap_m;
  Signal forward_rad, right_rad;
};

/// Whether this is a carrying position in which the camera is covered.
bool is_carry(const std::string& what);
bool is_covered(const std::string& carry);

}  // namespace odograph
