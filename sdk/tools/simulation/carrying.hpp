// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "sdk/tools/simulation/signal.hpp"

namespace odograph {

/// How a phone hangs on the trunk: its place against the trunk's base, forward, right and down, and the rotations about
/// these axes that make its attitude from an upright phone's.
struct Carried {
  Eigen::Vector3d offset;
  double pitch_rad, roll_rad;
};

/// Against the front of a thigh, as in a trouser pocket or a holster. The thigh swings about the hip once a stride,
/// about a mean flexion, and is flexed faster than it is extended (hip angle of 40 degrees in all: Winter, Biomechanics
/// and Motor Control of Human Movement, 2009). `phase`: whole numbers at the feet's contacts. `vigour`: of the gait, 1
/// at the usual step.
Carried on_leg(double phase, double vigour, double height_m);

/// In a bag on a strap: a damped pendulum about a shoulder that moves as the trunk does. Angles of the strap, forward
/// and to the right, for each sample of the trunk's place in n, m.
struct Bag {
  Bag(const std::vector<Eigen::Vector3d>& trunk_n, const Signal& heading_rad, double length_m, double damping,
      double rate_hz);
  Carried at(size_t sample, double height_m) const;

  double strap_m;
  Signal forward_rad, right_rad;
};

/// Whether a phone is carried so, and whether its camera then sees nothing.
bool is_carry(const std::string& what);
bool is_covered(const std::string& carry);

}  // namespace odograph
