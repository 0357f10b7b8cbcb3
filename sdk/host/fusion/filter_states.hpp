// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>

#include <Eigen/Core>

namespace odograph {

/// State of the filter, in this order. Position and heading belong to the newest pose of the track; together with the
/// track they define T_n_o.
enum StateIndex : int {
  kNorth,
  kEast,
  kDown,             ///< of the body in n, m
  kHeading,          ///< of o in n, rad: q_n_b = Rz(heading) q_o_b
  kHeadingRate,      ///< its rate, rad/s; 0 unless the orientation is integrated from a gyroscope
  kLogScale,         ///< log of metres per unit of the front-end's displacements
  kLogFactor,        ///< log of the true step length over the stated one
  kStepHeading,      ///< walking direction minus the heading that the steps state, rad
  kAttitudeHeading,  ///< of the attitude source's frame in n, rad: q_n_b = Rz(.) q_attitude
  kBarometer,        ///< barometric height downwards minus down, m
  kClimb,            ///< vertical velocity downwards while steps move the track, m/s
  kStates
};

/// Columns of a pose's errors in the filter's state.
inline constexpr int kPose[4] = {kHeading, kNorth, kEast, kDown};

using StateVector = Eigen::Matrix<double, kStates, 1>;
using StateSet = std::bitset<kStates>;

/// Derivative of a rotated vector by the heading: z x r.
inline Eigen::Vector3d across(const Eigen::Vector3d& r_n) { return {-r_n.y(), r_n.x(), 0.0}; }

}  // namespace odograph
