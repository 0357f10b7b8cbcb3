// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
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
    uint64_t edge_work = 16;     ///< of a Spend, for the height of an edge
    PhotographParameters matching = matching_on_path();
  };

  /// `model`: as read.
  explicit RoofSurvey(const City& model)
      : model_(model), ground_(model_.edges()), matcher_(model_, ground_, p_.matching) {}
  /// A match with the model as read, whose roofs have heights; none where the picture does not determine the place.
  std::optional<Match> match(const std::vector<SkyEdge>& edges, const PhotographPrior& prior, const Spend& spend);
  /// Adopts the heights of a match. Returns what it changes, for a report.
  std::string adopt(const Match& match);
  void forget();
  /// Puts the heights into `city`, the model, where they have changed since the last call.
  void correct_roofs(City& city, const Spend& spend);
  /// Adds the errors of the surveys whose roofs a match with the corrected city has used, by their share of the
  /// directions.
  void add_error(Match& match) const;

 private:
  static PhotographParameters matching_on_path();

  Parameters p_;
  City model_;
  Ground ground_;
  PhotographMatcher matcher_;
  std::unordered_map<int, double> heights_m_;                        // by object
  std::unordered_map<int, std::shared_ptr<const Match>> survey_of_;  // the same; without roofs
  bool changed_ = false;
};

}  // namespace odograph::skyline
