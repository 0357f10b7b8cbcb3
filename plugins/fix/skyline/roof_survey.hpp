// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "plugins/fix/skyline/photograph_matcher.hpp"

namespace odograph::skyline {

/// Matches single pictures of a path to a model whose roofs are metres too high or too low, and corrects the heights of
/// those in view. Thread: one at a time.
class RoofSurvey {
 public:
  /// Chosen empirically on drives through models of Delft and Linz with errors (`odograph city bench --roofs`).
  struct Parameters {
    double min_directions = 10;  ///< that agree on a roof's height: five degrees
    PhotographParameters matching = matching_on_path();
  };

  explicit RoofSurvey(City& city) : city_(city), ground_(city.edges()), matcher_(city, ground_, p_.matching) {}
  /// A match whose roofs have heights; none where the picture does not determine the place.
  std::optional<Match> match(const std::vector<SkyEdge>& edges, const PhotographPrior& prior, const Spend& spend);
  /// Raises the city's roofs to the heights of a match.
  void correct_model(const Match& match);
  /// Of the place from which roofs were corrected last: later matches against them have its error too.
  const Eigen::Matrix2d& covariance() const { return covariance_; }

 private:
  static PhotographParameters matching_on_path();

  Parameters p_;
  City& city_;
  Ground ground_;
  PhotographMatcher matcher_;
  std::unordered_map<int, double> heights_m_;  // by object
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Zero();
};

}  // namespace odograph::skyline
