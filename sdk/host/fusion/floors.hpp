// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sdk/host/fusion/outputs.hpp"
#include "sdk/math/ring.hpp"

namespace odograph {

/// Estimates the floor of a building, an integer, and its probability from the barometric height. The storey height is
/// unknown, so a bank of hypotheses ("buildings") runs in parallel, each with its own mean storey height. In each
/// hypothesis a level that was walked on is one of the floors or a landing; a hypothesis that explains the levels badly
/// loses weight. The floor follows from Bayes' rule with a prior uniform in height. Floors count from where the track
/// began. No allocation.
class FloorEstimator {
 public:
  /// Values are judgement where no source is named.
  struct Parameters {
    double storey_m = 3.4, storey_sigma_m = 0.8;  ///< mean height: dwellings 2.7, offices 3.5 to 4, museums and shops 5
    double lowest_m = 2.4, highest_m = 5.2;       ///< bounds of it; building codes require 2.3 to 2.5 m of clear height
    double storey_scatter = 0.12;                 ///< of one storey's height about the building's mean, relative
    double floor_sigma_m = 0.3;                   ///< of a height on a floor: hand motion, and lasting gusts
    double between = 0.15, between_storeys = 0.35;  ///< probability of stairs or a landing; their spread in storeys
    double drift_m = 0.02;                          ///< m/sqrt(s), pressure drift, as in Height::Parameters::walk
    double level_s = 6;     ///< s for which the height must be constant: longer than a stop on a landing
    double level_m = 0.8;   ///< m, maximum minus minimum of these heights
    double reported = 0.8;  ///< probability from which a floor is reported
    double other_m = 1;     ///< m from the previous level, beyond which a level is a new one
  };
  struct Floor {
    int32_t floor = 0;  ///< storeys above the first one
    double probability = 0;
  };

  FloorEstimator() : FloorEstimator(Parameters{}) {}
  explicit FloorEstimator(const Parameters& parameters);

  /// Adds the height of the body, m upwards, from an arbitrary origin. Ignores times before the newest.
  void add(int64_t t_ns, double up_m);
  /// Whether a height was added.
  bool has_height() const { return begun_; }
  Floor floor() const { return now_; }
  /// A new floor, once it is probable enough. The text is valid until the next call.
  std::optional<Notice> report();

 private:
  static constexpr size_t kBuildings = 25;           ///< number of hypotheses
  static constexpr int kFloors = 48, kLowest = -15;  ///< modelled floor numbers: -15 to 32
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
    double storey_m = 0, weight = 0;  ///< the weights sum to 1
    std::array<Level, kFloors> levels{};
    std::array<int, kFloors> nearest{};  ///< for each floor, the index of the nearest visited one
  };
  /// Likelihoods of a height, 1/m: on a floor; on it, or on the stairs or a landing nearest to it.
  struct Likelihood {
    double on_it, either;
  };
  Likelihood likelihood(double up_m, const Building& building, int index, int64_t t_ns) const;
  Floor nearest(int64_t t_ns, double up_m) const;
  void update_level(int64_t t_ns, double up_m);
  double update_level(Building& building, int64_t t_ns, double up_m) const;

  Parameters p_;
  bool begun_ = false;
  Floor now_;
  int32_t reported_ = 0;
  std::array<char, 80> text_{};
  double level_m_ = 0;  ///< height of the newest level
  std::array<Building, kBuildings> buildings_{};
  Ring<Height, 64> heights_;  ///< at least a quarter of a second apart
};

}  // namespace odograph
