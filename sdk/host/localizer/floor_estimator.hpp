// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sdk/math/ring.hpp"

namespace odograph {

/// The floor of a building as a whole number with its probability, from the height that the barometer gives. Nobody
/// says how high its storeys are: that is a distribution over their mean height, which each new level narrows; a floor
/// that was walked on has the height that was measured there. The floor is that of the nearest heights in the sense of
/// Bayes' rule, each floor as likely as the next. Counted from the floor where the track began. No allocation.
class FloorEstimator {
 public:
  /// Judgement where no source is named.
  struct Parameters {
    double storey_m = 3.2, storey_sigma_m = 0.6;  ///< mean height: dwellings 2.7, offices 3.5 to 4, museums and shops 5
    double lowest_m = 2.4, highest_m = 5.2;       ///< of that mean; building codes ask for 2.3 to 2.5 m of clear height
    double storey_scatter = 0.12;                 ///< of one storey's height, about the building's mean, relative
    double floor_sigma_m = 0.35;                  ///< of a height on a floor: the hand's, and gusts that last
    double between = 0.15, between_storeys = 0.35;  ///< how likely he is on stairs or a half storey, and how far off
    double drift_m = 0.02;                          ///< m/sqrt(s), of the pressure, as HeightUpdate's walk
    double level_s = 6;    ///< s within which a floor is level: longer than a landing is stood on
    double level_m = 0.8;  ///< m, highest less lowest of these heights
    double known = 0.6;    ///< probability from which a level is taken for this floor's
  };
  struct Floor {
    int32_t floor = 0;  ///< storeys above the first one
    double probability = 0;
  };

  FloorEstimator() : FloorEstimator(Parameters{}) {}
  explicit FloorEstimator(const Parameters& parameters);

  /// The height of the body, m upwards, from anywhere. Earlier times than the newest are passed over.
  void add(int64_t t_ns, double up_m);
  /// Whether there was a height.
  bool known() const { return begun_; }
  Floor floor() const { return now_; }

 private:
  static constexpr int kFloors = 48, kLowest = -15;  ///< numbers that are told apart: -15 to 32
  static constexpr size_t kStoreys = 25;             ///< hypotheses of the storeys' mean height
  struct Height {
    int64_t t_ns;
    double up_m;
  };
  struct Level {
    bool visited = false;
    double up_m = 0, variance_m2 = 0;
    int64_t t_ns = 0;
  };
  struct Expected {
    double up_m, variance_m2;
  };
  double storey_m(size_t hypothesis) const;
  Expected expected(int floor, size_t hypothesis, int64_t t_ns) const;
  double likelihood(double up_m, int floor, size_t hypothesis, int64_t t_ns) const;
  Floor nearest(int64_t t_ns, double up_m) const;
  void see_level(int64_t t_ns, double up_m);

  Parameters p_;
  bool begun_ = false;
  Floor now_;
  std::array<double, kStoreys> weights_{};  ///< of the hypotheses; their sum is 1
  std::array<Level, kFloors> levels_{};
  Ring<Height, 64> heights_;  ///< a quarter of a second apart at least
};

}  // namespace odograph
