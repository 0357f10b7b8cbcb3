// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "plugins/fix/skyline/look.hpp"
#include "plugins/fix/skyline/photograph_level.hpp"
#include "plugins/fix/skyline/photograph_matcher.hpp"
#include "plugins/fix/skyline/sky_eye.hpp"

namespace odograph::skyline {

/// One photograph, a city model and where it was taken roughly: a pose, or why there is none. Thread: one at a time.
class PhotographFixer {
 public:
  struct Parameters {
    int widest_px = 1280;      ///< larger pictures are halved: a tenth of a degree a pixel is enough for roofs
    double level_rad = 0.052;  ///< sigma of the prior's inclination, from where on it is looked for: 3 degrees
    double agree_m = 4;        ///< between the places that the sky in colour and in grey lead to; judgement
    PhotographLevelParameters level;
  };
  struct Answer {
    std::optional<Match> match;
    std::optional<Match> tried;  ///< what was refused, for tests and tools
    double gain = 0;
    std::string why;      ///< there is none
    bool no_sky = false;  ///< that is the reason
    double other = 1;     ///< probability that it is elsewhere
  };

  explicit PhotographFixer(City& city, const PhotographParameters& matching = {})
      : ground_(city.edges()), matcher_(city, ground_, matching) {}
  /// The prior's place counts for north and east; its height where the model has no ground there.
  Answer place(Picture picture, const PhotographPrior& prior);
  const Ground& ground() const { return ground_; }

 private:
  Answer agreed(Answer colour, Answer grey) const;

  Parameters p_;
  Ground ground_;
  PhotographMatcher matcher_;
  SkyEye eye_;
};

}  // namespace odograph::skyline
