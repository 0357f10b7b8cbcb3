// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace odograph::skyline {

/// Every number of the matcher that could be another one. What has no source named was chosen by hand on drives through
/// a model of Delft (`odograph city bench`); no sweep of it is recorded.
struct MatcherParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  // The loss of a direction.
  double noise_rad = 0.25 * kDegree;  ///< least mean loss believed
  double soft_rad = 0.6 * kDegree;    ///< from here on a direction pulls less and less (Geman & McClure 1987)
  double max_rad = 3 * kDegree;       ///< a direction's largest loss: models miss trees and new houses
  double correlated = 12;             ///< neighbouring directions that err together: six degrees
  double lowest_rad = 3 * kDegree;    ///< what stands lower is not looked at: parked cars, hedges, far hills
  double agrees_rad = 1.0 * kDegree;  ///< of a direction in which picture and model agree
  size_t min_edges = 240;             ///< a third of the directions: fewer have been seen to fit in wrong places
  // The lattice of places.
  double nearest_m = 6;                           ///< always searched: priors are optimistic
  double wide_m = 12;                             ///< farther than this the lattice is coarse:
  double fine_step_m = 1.5, coarse_step_m = 2.0;  ///< between its places
  uint64_t rotated_cheaper = 3;                   ///< times, a rotated direction's loss than another's; measured
  double hopeless_rad = 0.3 * kDegree;            ///< of a move's mean loss: no heading makes up for it
  // The refinement.
  double spread_m = 2.5;                                                 ///< between places that are refined
  size_t starts = 2, starts_of_path = 6;                                 ///< how many of them
  double derivative_step_m = 0.25, derivative_step_rad = 0.5 * kDegree;  ///< of the model's skyline, numeric
  double max_step_m = 2;                                                 ///< of an iteration
  int last_steps = 2;                                                    ///< of the best place, with the narrowest loss
  double outside_m = 2;      ///< a cell of the coarse lattice: so far beyond it a place may be refined to
  double height_sigmas = 3;  ///< of the prior's height, which a place must lie within
  double climbed_m = 1;      ///< its least sigma: what a road may have climbed since the last fix
  // Other places.
  double apart_m = 4;  ///< farther from each other than this two places are two
  int pictures = 4;    ///< that must have been seen before one of the lost is believed
  // The doubt about the best one.
  double disagreement_m = 2.5;  ///< standard deviation of a place with which nothing agrees; measured in Delft
  double untold_m = 10;         ///< across the best told axis, by the curvature: more, and a picture tells no place
  int sounded = 3;              ///< cells around the best place, to each side,
  double sounded_step_m = 2;    ///< so far apart
  size_t sounded_starts = 3;    ///< of those that are refined
  double alike = 0.1;           ///< of the best place's likelihood: one at the rim that has it says that more follow
  double unseen_m = 30;         ///< standard deviation along a direction that a picture does not tell
};

}  // namespace odograph::skyline
