// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "plugins/fix/skyline/picture_job.hpp"
#include "plugins/fix/skyline/photograph_level.hpp"
#include "plugins/fix/skyline/photograph_matcher.hpp"
#include "plugins/fix/skyline/sky_detector.hpp"

namespace odograph::skyline {

/// Estimates the pose of one photograph from a city model and a rough prior, or gives the reason why not. Thread: one
/// at a time.
class PhotographFixer {
 public:
  struct Parameters {
    int widest_px = 1280;      ///< larger pictures are reduced: a tenth of a degree per pixel suffices for roofs
    double level_rad = 0.052;  ///< sigma of the prior's inclination above which it is estimated: 3 degrees
    PhotographLevelParameters level;
  };
  struct Outcome {
    std::optional<Match> match = std::nullopt;
    std::string why = {};    ///< reason for no match,
    Reason reason = kPrior;  ///< and its kind
  };

  explicit PhotographFixer(City& city, const PhotographParameters& matching = {})
      : ground_(city.edges()), facades_(city.edges()), matcher_(city, ground_, matching) {}
  /// The prior's north and east are used; its height only where the model has no ground.
  Outcome estimate_pose(Picture picture, const PhotographPrior& prior);
  const Ground& ground() const { return ground_; }

 private:
  Parameters p_;
  Ground ground_;
  Facades facades_;
  PhotographMatcher matcher_;
  SkyDetector sky_detector_;
};

}  // namespace odograph::skyline
