// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <vector>

#include "plugins/fix/skyline/seen_skyline.hpp"

namespace odograph::skyline {

/// A place of the search, and the cost of the picture there.
struct Place {
  Guess guess;
  double cost;
};

/// The running mean over several pictures of the cost of each offset from the prior. Between two pictures an offset is
/// constant to one cell, the odometry's drift.
class OffsetMap {
 public:
  /// Chosen empirically on drives through a model of Delft.
  struct Parameters {
    double newest = 0.35;                            ///< weight of the newest picture in the mean
    double slip_rad = 0.1 * std::numbers::pi / 180;  ///< added cost of an offset that moves by a cell
  };
  OffsetMap() : OffsetMap(Parameters{}) {}
  explicit OffsetMap(const Parameters& parameters) : p_(parameters) {}

  void clear() { pictures_ = 0; }
  /// Replaces the costs of `places`, which lie on a lattice of `step_m`, by the means. Returns the number of pictures.
  int average(std::vector<Place>& places, double step_m);

 private:
  Parameters p_;
  std::vector<float> means_, before_;
  int reach_ = -1, pictures_ = 0;
};

}  // namespace odograph::skyline
