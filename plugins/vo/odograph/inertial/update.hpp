// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "plugins/vo/odograph/inertial/observe.hpp"

namespace odograph::vio {

/// Residuals that depend on a part of the state: `H` has one column for each of `columns`.
struct Linearised {
  Eigen::VectorXd residual;
  Eigen::MatrixXd H;
  std::vector<int> columns;
};

struct Outcome {
  bool accepted = false;
  double nis = 0;  ///< normalised innovation squared
  int dof = 0;
  double rms_px = 0;  ///< of a triangulated track's reprojection errors; 0: no track
};

/// Kalman update with independent noise of `sigma` on each residual. Rejects innovations beyond the 1 - `tail` quantile
/// of chi-square, evaluated with `gate_sigma` (no gate if tail is 0).
Outcome update(State& state, const Linearised& z, double sigma, double gate_sigma, double tail);

/// 1 - `tail` quantile of chi-square (Wilson & Hilferty 1931).
double chi_square_bound(int dof, double tail);

/// Updates with a track whose point is not a state: the point is eliminated by the left null space (Mourikis &
/// Roumeliotis 2007). Rejected if the depth is unobservable.
Outcome update_with_track(State& state, const std::vector<Observation>& track, const FilterParameters& p);

/// The same, and adds the point as a landmark. A point without parallax gets a wide prior on its inverse depth.
Outcome add_landmark(State& state, uint64_t track_id, const std::vector<Observation>& track, const FilterParameters& p);

/// An observed landmark.
struct SeenLandmark {
  size_t landmark = 0;  ///< index in State::landmarks
  Observation at;
};

/// Updates with several landmarks, each gated separately. A landmark behind the camera has zero degrees of freedom.
std::vector<Outcome> update_with_landmarks(State& state, const std::vector<SeenLandmark>& seen,
                                           const FilterParameters& p);

/// Specific force of a body at rest: minus gravity plus the accelerometer bias, within sigma (m/s^2).
Outcome update_gravity(State& state, const Eigen::Vector3d& force_b, double gravity_mps2, double sigma_mps2);

/// Fixes a lens without stabiliser: its shift and that of all clones are set to zero.
void disable_stabiliser(State& state);

/// Zero-velocity update, within sigma (m/s).
Outcome update_zero_velocity(State& state, double sigma_mps);

}  // namespace odograph::vio
