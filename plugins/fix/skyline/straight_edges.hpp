// SPDX-License-Identifier: Apache-2.0
//
// The straight edges of a picture's skyline.
#pragma once

#include <vector>

#include "plugins/fix/skyline/seen_skyline.hpp"

namespace odograph::skyline {

/// Costs of the description of a line, nats.
struct StraightEdgeCosts {
  double edge;       ///< of a straight edge
  double sigma_rad;  ///< of its directions
  double ragged;     ///< of a direction that belongs to none,
  double exact;      ///< and of one that fits its edge exactly, per weight; negative
  double part;       ///< of a direction's deviation that counts, since its neighbours have the same error
};

constexpr int kRagged = -1;

/// The straight edge, a great circle, to which each direction belongs, by number, or kRagged: the shortest description
/// of the line (Rissanen 1978) by dynamic programming. `directions`: in order; `weights`: theirs, 0 where there is no
/// line.
std::vector<int> straight_edges(const std::vector<SkyEdge>& directions, const std::vector<double>& weights,
                                const StraightEdgeCosts& costs);

}  // namespace odograph::skyline
