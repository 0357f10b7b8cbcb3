// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/roof_survey.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace odograph::skyline {

/// The heading of a path is unknown or has a Gaussian error without outliers, and its position is known better than a
/// photograph's.
PhotographParameters RoofSurvey::matching_on_path() {
  PhotographParameters p;
  p.min_m = 6, p.max_m = 12, p.decision.min_agreement = 0.45, p.decision.max_other = 0.02;
  p.decision.power = p.decision.spread_power = 0.6;  // a path's pictures are matched without their facades
  p.decision.unmodelled = 0.002;                     // less, because their inclination and height are known; judgement
  p.decision.straight_roofs = false;  // its fits, without the pattern search, miss the ends of houses by centimetres
  p.refinement.starts = 60, p.refinement.polished = 0, p.refinement.fits_wide = true;
  return p;
}

std::optional<Match> RoofSurvey::match(const std::vector<SkyEdge>& edges, const PhotographPrior& prior,
                                       const Spend& spend) {
  matcher_.clear(), matcher_.add(edges, prior, spend);
  auto match = matcher_.match();
  // Beyond the search other places were not compared.
  if (match && (match->p_n - prior.p_n).head<2>().norm() > matcher_.reach_m()) match.reset();
  return match;
}

std::string RoofSurvey::adopt(const Match& match) {
  int buildings = 0;
  double largest_m = 0;
  const auto survey = std::make_shared<Match>(match);
  survey->roofs.clear();
  for (const RoofHeight& roof : match.roofs) {
    if (roof.directions < p_.min_directions) continue;
    heights_m_[roof.object] = roof.height_m, survey_of_[roof.object] = survey;
    ++buildings, largest_m = std::max(largest_m, std::abs(roof.height_m));
  }
  changed_ |= buildings > 0;
  char text[80];
  std::snprintf(text, sizeof text, "%d buildings are up to %.1f m higher or lower than in the model", buildings,
                largest_m);
  return text;
}

void RoofSurvey::forget() {
  changed_ |= !heights_m_.empty();
  heights_m_.clear(), survey_of_.clear();
}

void RoofSurvey::correct_roofs(City& city, const Spend& spend) {
  if (!changed_) return;
  spend(p_.edge_work * model_.edges().size());
  city = model_.with_roof_offsets(heights_m_);
  changed_ = false;
}

void RoofSurvey::add_error(Match& match) const {
  double all = 0;
  for (const RoofHeight& roof : match.roofs) all += roof.directions;
  for (const RoofHeight& roof : match.roofs) {
    const auto found = survey_of_.find(roof.object);
    if (found == survey_of_.end() || roof.directions == 0) continue;
    const Match& survey = *found->second;
    const double share = roof.directions / all;
    match.covariance += share * survey.covariance;
    match.yaw_sigma_rad = std::hypot(match.yaw_sigma_rad, std::sqrt(share) * survey.yaw_sigma_rad);
    match.height_sigma_m = std::hypot(match.height_sigma_m, std::sqrt(share) * survey.height_sigma_m);
    match.second_best_ratio = std::max(match.second_best_ratio, survey.second_best_ratio);
  }
}

}  // namespace odograph::skyline
