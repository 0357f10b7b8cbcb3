// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace odograph::skyline {

/// Parameters of the matcher. Unless a source is named, chosen empirically on drives through a model of Delft
/// (`odograph city bench`); no sweep is recorded.
struct MatcherParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  // The loss of a direction.
  double noise_rad = 0.25 * kDegree;  ///< min mean loss
  double soft_rad = 0.6 * kDegree;    ///< scale of the robust loss (Geman & McClure 1987)
  double max_rad = 3 * kDegree;       ///< max loss of a direction: models lack trees and new houses
  double correlated = 12;             ///< neighbouring directions with a common error: six degrees
  bool correlation = false;           ///< places are compared by eq. (3) instead, without a bound
  double lowest_rad = 3 * kDegree;    ///< lower objects are ignored: parked cars, hedges, far hills
  double agrees_rad = 1.0 * kDegree;  ///< max difference of a direction in which picture and model agree
  size_t min_edges = 240;             ///< a third of the directions: pictures with fewer have matched wrong places
  // The lattice of places.
  double nearest_m = 6;                           ///< min radius of the search: priors are optimistic
  double wide_m = 12;                             ///< radius above which the lattice is coarse:
  double fine_step_m = 1.5, coarse_step_m = 2.0;  ///< between its places
  uint64_t rotated_cheaper = 3;      ///< factor by which a direction's loss is cheaper in a rotated skyline; measured
  double prune_rad = 0.3 * kDegree;  ///< increase of the mean loss by a move that no heading compensates
  // The refinement.
  double spread_m = 2.5;                  ///< min distance between places that are refined
  size_t starts = 2, starts_of_path = 6;  ///< their number
  double derivative_step_m = 0.25, derivative_step_rad = 0.5 * kDegree;  ///< numeric, of the model's skyline
  double max_step_m = 2;                                                 ///< per iteration
  int last_steps = 2;        ///< iterations at the best place with the narrowest loss
  double outside_m = 2;      ///< max distance of a refined place outside the lattice: a coarse cell
  double height_sigmas = 3;  ///< max deviation from the prior's height
  double climbed_m = 1;      ///< min sigma of the height: the road's climb since the last fix
  // Other places.
  double apart_m = 4;  ///< places farther apart than this are distinct
  int pictures = 4;    ///< needed before a match is accepted when lost
  // Uncertainty of the best place.
  double disagreement_m = 2.5;  ///< standard deviation at zero agreement; measured in Delft
  double max_axis_sigma_m =
      10;              ///< max sigma along the best-determined axis, by the curvature; above, there is no match
  int neighbours = 3;  ///< neighbours of the best place to each side,
  double neighbour_step_m = 2;     ///< their spacing,
  size_t neighbour_starts = 3;     ///< and the number of those that are refined
  double alike = 0.1;              ///< likelihood ratio of a place at the rim above which the ridge continues
  double unobserved_sigma_m = 30;  ///< standard deviation along a direction that a picture does not determine
};

}  // namespace odograph::skyline
