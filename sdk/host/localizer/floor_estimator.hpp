// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sdk/math/ring.hpp"

namespace odograph {

/// The floor of a building as a whole number with its probability, from the height that the barometer gives. Nobody
/// says how high its storeys are, so several buildings are thought of side by side, each with a mean height of its
/// storeys: in each of them a level that was walked on is one of its floors, or a landing, and a building where the
/// levels lie badly loses weight. The floor is that of the nearest heights in the sense of Bayes' rule, each floor as
/// likely as the next. Counted from the floor where the track began. No allocation.
class FloorEstimator {
 public:
  /// Judgement where no source is named.
  struct Parameters {
    double storey_m = 3.4, storey_sigma_m = 0.8;  ///< mean height: dwellings 2.7, offices 3.5 to 4, museums and shops 5
    double lowest_m = 2.4, highest_m = 5.2;       ///< of it; building codes ask for 2.3 to 2.5 m of clear height
    double storey_scatter = 0.12;                 ///< of one storey's height, about the building's mean, relative
    double floor_sigma_m = 0.3;                   ///< of a height on a floor: the hand's, and gusts that last
    double between = 0.15, between_storeys = 0.35;  ///< how likely the walker is on stairs or a landing, how far off
    double drift_m = 0.02;                          ///< m/sqrt(s), of the pressure, as HeightUpdate's walk
    double level_s = 6;    ///< s within which a floor is level: longer than a landing is stood on
    double level_m = 0.8;  ///< m, highest less lowest of these heights
    double other_m = 1;    ///< m from the level before, which make it another
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
  static constexpr size_t kBuildings = 25;           ///< thought of side by side
  static constexpr int kFloors = 48, kLowest = -15;  ///< numbers that are told apart: -15 to 32
  struct Height {
    int64_t t_ns;
    double up_m;
  };
  struct Level {
    bool visited = false;
    double up_m = 0, variance_m2 = 0;
    int64_t t_ns = 0;
  };
  struct Building {
    double storey_m = 0, weight = 0;  ///< the weights' sum is 1
    std::array<Level, kFloors> levels{};
    std::array<int, kFloors> nearest{};  ///< of each floor, the visited one: its index
  };
  /// Of a height, 1/m: of one who is on a floor, and on the stairs or a landing nearest to it.
  struct Likelihood {
    double on_it, either;
  };
  Likelihood likelihood(double up_m, const Building& building, int index, int64_t t_ns) const;
  Floor nearest(int64_t t_ns, double up_m) const;
  void see_level(int64_t t_ns, double up_m);
  double see_level(Building& building, int64_t t_ns, double up_m) const;

  Parameters p_;
  bool begun_ = false;
  Floor now_;
  double level_m_ = 0;  ///< the newest level's height
  std::array<Building, kBuildings> buildings_{};
  Ring<Height, 64> heights_;  ///< a quarter of a second apart at least
};

}  // namespace odograph
