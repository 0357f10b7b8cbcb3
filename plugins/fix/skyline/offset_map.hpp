// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  void clear() { pictures_ = 0; }
  /// Replaces the costs of `places`, which lie on a lattice of `step_m`, by the means. Returns how many pictures count.
  int average(std::vector<Place>& places, double step_m);

 private:
  std::vector<float> means_, before_;
  int reach_ = -1, pictures_ = 0;
};

}  // namespace odograph::skyline
