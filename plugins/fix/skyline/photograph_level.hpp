// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "plugins/fix/skyline/vanishing_point.hpp"

namespace odograph::skyline {

/// How a photograph may have been held, where nothing has measured it.
struct PhotographLevelParameters {
  static constexpr double kDegree = 3.14159265358979323846 / 180;
  // Judgement: people hold a camera upright, to ten degrees, and its axis level or up.
  double lowest_rad = -15 * kDegree, highest_rad = 40 * kDegree, pitch_step_rad = 5 * kDegree;
  double roll_rad = 8 * kDegree;         ///< to each side, a start each
  double usual_roll_rad = 4 * kDegree;   ///< sigma of the roll
  double same_rad = 1.5 * kDegree;       ///< nearer than this two zeniths are one
  double others_part = 0.7;              ///< of the best one's lines that another one has
  size_t most = 3;                       ///< inclinations that are tried
  double min_sigma_rad = 0.6 * kDegree;  ///< of one by upright lines, which half of the time errs by more than it says
  double unknown_sigma_rad = 4 * kDegree;  ///< of one that is guessed
  VanishingPointParameters lines{.max_off_rad = 0.12, .min_lines = 10};
};

struct PhotographLevel {
  Eigen::Vector3d up_c;  ///< the zenith, unit
  double sigma_rad;
  int lines;  ///< that say so; 0: a guess
};

/// The inclinations that the upright lines of a photograph allow, the likeliest first; guesses where there are no such
/// lines. `lines`: of the picture; `level_up_c`: where the zenith would be if the camera were held upright and level.
std::vector<PhotographLevel> levels_of(const std::vector<SeenLine>& lines, const Eigen::Vector3d& level_up_c,
                                       const PhotographLevelParameters& parameters = {});

}  // namespace odograph::skyline
