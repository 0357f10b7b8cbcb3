// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <vector>

#include "plugins/fix/skyline/seen_skyline.hpp"

namespace odograph::skyline {

/// A place of the search, and how well the picture fits there.
struct Place {
  Guess guess;
  double cost;
};

/// What several pictures say of each offset from the prior: their costs' running mean. An offset holds from picture to
/// picture but for what the odometry errs by meanwhile: a cell.
class OffsetMap {
 public:
  /// Chosen by hand on drives through a model of Delft.
  struct Parameters {
    double newest = 0.35;                            ///< a picture's part of an offset's mean
    double slip_rad = 0.1 * std::numbers::pi / 180;  ///< loss of an offset that moves by a cell: it is likelier to stay
  };
  OffsetMap() : OffsetMap(Parameters{}) {}
  explicit OffsetMap(const Parameters& parameters) : p_(parameters) {}

  void clear() { pictures_ = 0; }
  /// Replaces the costs of `places`, which lie on a lattice of `step_m`, by the means. Returns how many pictures count.
  int average(std::vector<Place>& places, double step_m);

 private:
  Parameters p_;
  std::vector<float> means_, before_;
  int reach_ = -1, pictures_ = 0;
};

}  // namespace odograph::skyline
