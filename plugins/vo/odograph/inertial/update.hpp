// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "plugins/vo/odograph/inertial/observe.hpp"

namespace odograph::vio {

/// Residuals that depend on some of the states: `H` has one column for each of `columns`.
struct Linearised {
  Eigen::VectorXd residual;
  Eigen::MatrixXd H;
  std::vector<int> columns;
};

struct Outcome {
  bool accepted = false;
  double nis = 0;  ///< normalised innovation squared
  int dof = 0;
  double rms_px = 0;  ///< of a triangulated track's corners beside one point; 0: no track
};

/// Kalman update with independent noise of `sigma` on each residual; refused where the innovation is larger than the
/// chi-square distribution has it with noise of `gate_sigma` in 1 - `tail` of the cases (no gate where tail is 0).
Outcome update(State& state, const Linearised& z, double sigma, double gate_sigma, double tail);

/// 1 - `tail` quantile of chi-square (Wilson & Hilferty 1931).
double chi_square_bound(int dof, double tail);

/// A track whose point is no state: its point is taken out of the equations (left null space, Mourikis & Roumeliotis
/// 2007). Nothing accepted where the track tells no depth.
Outcome update_with_track(State& state, const std::vector<Observation>& track, const FilterParameters& p);

/// The same, and the point becomes a landmark. A point without parallax gets a wide prior on its inverse depth.
Outcome add_landmark(State& state, uint64_t track_id, const std::vector<Observation>& track, const FilterParameters& p);

/// A landmark seen again.
struct SeenLandmark {
  size_t landmark = 0;  ///< of State::landmarks
  Observation at;
};

/// Some together, each gated by itself. A landmark behind the camera gives an outcome without degrees of freedom.
std::vector<Outcome> update_with_landmarks(State& state, const std::vector<SeenLandmark>& seen,
                                           const FilterParameters& p);

/// The specific force of a body at rest, minus gravity and the accelerometer's bias, within sigma (m/s^2).
Outcome update_gravity(State& state, const Eigen::Vector3d& force_b, double gravity_mps2, double sigma_mps2);

/// A lens without stabiliser: neither it nor any clone's was ever shifted.
void hold_lens(State& state);

/// The body stands: v = 0 within sigma (m/s).
Outcome update_zero_velocity(State& state, double sigma_mps);

}  // namespace odograph::vio
