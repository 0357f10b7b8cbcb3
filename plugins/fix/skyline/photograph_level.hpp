// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/vanishing_point.hpp"

namespace odograph::skyline {

/// Prior of a photograph's inclination where it was not measured.
struct PhotographLevelParameters {
  static constexpr double kDegree = 3.14159265358979323846 / 180;
  // Judgement: people hold a camera upright to ten degrees, with its axis horizontal or up.
  double lowest_rad = -15 * kDegree, highest_rad = 40 * kDegree, pitch_step_rad = 5 * kDegree;
  double roll_rad = 8 * kDegree;         ///< start values at this roll to each side
  double usual_roll_rad = 8 * kDegree;   ///< roll that halves the number of lines: twice the sigma of a hand
  double same_rad = 1.5 * kDegree;       ///< zeniths nearer than this are the same
  double others_part = 0.7;              ///< min number of lines of another zenith over that of the best
  size_t most = 3;                       ///< max number of inclinations
  double min_sigma_rad = 0.6 * kDegree;  ///< from vertical lines: half of the errors exceed the stated sigma
  double guesses_rad[3] = {8 * kDegree, 0, 16 * kDegree};  ///< pitches without such lines,
  double unknown_sigma_rad = 4 * kDegree;                  ///< and their sigma; a prior of up to twice this needs none
  double prior_sigmas = 3;                                 ///< max angle from the prior's zenith, in its sigmas
  double min_across = 0.17;  ///< min sine of the angle between the axis and the zenith: 10 degrees
  VanishingPointParameters lines{.max_off_rad = 0.12, .min_lines = 10};
};

struct PhotographLevel {
  Eigen::Vector3d up_c;  ///< the zenith, unit
  double sigma_rad;
  int lines;  ///< number of supporting lines; 0: a guess
};

/// The inclinations that are consistent with the vertical lines of a photograph, the likeliest first; guesses where
/// there are no such lines. `lines`: of the picture; `prior`: the camera is held with its roll, to 8 degrees, and the
/// inclinations are near it, to its sigma. The prior alone where none is, or for a camera that faces the zenith.
std::vector<PhotographLevel> levels_of(const std::vector<SeenLine>& lines, const PhotographLevel& prior,
                                       const PhotographLevelParameters& parameters = {});

/// The orientation with the same heading of the axis and this zenith in c, a unit vector.
Eigen::Quaterniond levelled(const Eigen::Quaterniond& q_n_c, const Eigen::Vector3d& up_c);

}  // namespace odograph::skyline
