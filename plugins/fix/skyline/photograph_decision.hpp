// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "plugins/fix/skyline/validate_match.hpp"

namespace odograph::skyline {

/// Requirements for a match of a photograph, and how its uncertainty is computed. Unless a source is named, chosen
/// empirically on rendered pictures of Delft and Linz (docs/accuracy/city.md).
struct PhotographDecisionParameters {
  double min_agreement = 0.4;  ///< fraction of the directions with a roof's edge where picture and model agree
  double max_sigma_m = 5;      ///< of the position along its worst axis
  double max_yaw_sigma_rad = 10 * std::numbers::pi / 180;  ///< half of a compass's: less would not help; judgement
  double min_sigma_m = 0.5;  ///< of north and of east: no model's corners are more accurate (CityGML 2.0, LOD3: 0.5 m)
  double mode_radius_m = 6;  ///< of the places that form the covariance; those beyond three sigmas are others
  double max_near = 0.004;   ///< probability of those beyond three sigmas above which the covariance is enlarged
  double max_other = 0.05;   ///< total probability of places beyond three sigmas and of no place; of accepted
                             ///< photographs it is below 1 % on average
  double facade_evidence = 4;    ///< max log-likelihood of the facades against chance: any street's lines have two
                                 ///< directions, so that only their heading is evidence, a degree of ninety
  bool straight_roofs = true;    ///< straight roofs that the model lacks are compared with the match
  double straight_volume = 0.5;  ///< part of the place's log-volume that counts there: of as many places one fits by
                                 ///< chance, but the roofs' own places count too
  double unmodelled = 0.2;       ///< odds, before the picture is seen, that the model has nothing of it; judgement
  double power = 0.8;            ///< of the likelihoods, since the model's errors are not those assumed
  double spread_power = 0.5;     ///< the same for the places that form the covariance: along a street the roofs' ends
                                 ///< alone determine the place, and their errors have longer tails
  double sky_power = 0.22;       ///< the same between a photograph's hypotheses, in addition
  double modelled_power = 3;     ///< the fraction of a line that a model has is distributed as its power: mean 80 %
  double roof_distance_m = 10;   ///< typical distance of a roof: min_sigma_m of its corners, seen from there, is the
                                 ///< heading's min sigma
};

/// A place where a photograph's line fits the model better than in the surroundings.
struct PhotographPlace {
  Eigen::Vector3d at;  ///< north, east, m; yaw, rad
  double gain;         ///< log-likelihood over that of a place where nothing fits
  double log_volume;   ///< of the standard deviations in place, orientation and height, over the prior's
  Eigen::Matrix3d covariance;
  double facade_gain = 0;  ///< the facades' part of the gain
};

/// The places by one hypothesis about the photograph: a sky and an inclination.
struct PhotographAttempt {
  Match match;                          ///< of the best place, without covariance
  std::vector<PhotographPlace> places;  ///< the best one first
  double possible_gain = 0;             ///< of a place where all roofs fit
  double straight_gain = 0;             ///< of the best place, as RoofLineFit's, with the prior and the facades
  double outside = 0;                   ///< probability by the prior that the camera is outside the search
};

struct PhotographDecision {
  std::optional<Match> tried;  ///< the best place, accepted or rejected
  std::string why = {};        ///< reason for the rejection; empty where the place is accepted,
  Reason reason = kPrior;      ///< and its kind
  double gain = -1e9;          ///< of the best place
  double other = 1;            ///< probability that the camera is beyond three sigmas of it, or not in the model at all
  bool chance = false;         ///< most of that is the probability that the line fits by chance
};

/// The best of the places of all attempts, at least one, and its uncertainty.
PhotographDecision decide(const std::vector<PhotographAttempt>& attempts,
                          const PhotographDecisionParameters& parameters);

}  // namespace odograph::skyline
