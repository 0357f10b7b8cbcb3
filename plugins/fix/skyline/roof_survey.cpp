// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/roof_survey.hpp"

namespace odograph::skyline {

/// A path has a heading or none, never a wrong one, and its position is known better than a photograph's.
PhotographParameters RoofSurvey::matching_on_path() {
  PhotographParameters p;
  p.min_m = 6, p.max_m = 12, p.wrong_heading = 0, p.decision.min_agreement = 0.45;
  p.decision.power = 0.6;  // a path's pictures are matched without their facades
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

void RoofSurvey::correct_model(const Match& match) {
  for (const RoofHeight& roof : match.roofs)
    if (roof.directions >= p_.min_directions) heights_m_[roof.object] += roof.height_m;
  city_.raise(heights_m_);
  covariance_ = match.covariance;
}

}  // namespace odograph::skyline
