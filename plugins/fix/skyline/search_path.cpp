// SPDX-License-Identifier: Apache-2.0
//
// The coarse search for a path of several pictures.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>

#include "plugins/fix/skyline/match_terms.hpp"
#include "plugins/fix/skyline/matcher.hpp"

namespace odograph::skyline {

/// A lattice of places for the newest picture, each with the best of the headings in reach. The places of the others
/// rotate with the heading: the city's skylines are cached by cells of the lattice.
void Matcher::search_path(double radius_m, double step_m) {
  std::unordered_map<int64_t, SeenSkyline::Twice> cells;
  Horizon horizon;
  const auto skyline_near = [&](const Eigen::Vector3d& p) -> const SeenSkyline::Twice& {
    const Eigen::Vector3d d = p - prior_.p_n;
    const auto north = std::lround(d.x() / step_m), east = std::lround(d.y() / step_m);
    const auto [cell, is_new] = cells.try_emplace((int64_t{north} << 32) + east);
    if (!is_new) return cell->second;
    spend(city_.quick_work());
    const auto north_m = static_cast<double>(north) * step_m, east_m = static_cast<double>(east) * step_m;
    city_.quick_horizon(prior_.p_n + Eigen::Vector3d(north_m, east_m, 0), horizon);
    const auto middle = std::copy(horizon.elevation.begin(), horizon.elevation.end(), cell->second.begin());
    std::copy(horizon.elevation.begin(), horizon.elevation.end(), middle);
    return cell->second;
  };
  const int reach = static_cast<int>(std::ceil(radius_m / step_m));
  const int yaw_steps = static_cast<int>(std::ceil(std::min(3 * prior_.yaw_sigma_rad, std::numbers::pi) / kDegree));
  double total = 0;
  uint64_t directions = 0;
  for (const auto& seen : seen_.seen()) {
    total += seen.skyline.turned_weight();
    directions += seen.skyline.turned_size();
  }
  places_.clear();
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b) {
      Place best{{.north = a * step_m, .east = b * step_m}, 1e9};
      spend(static_cast<uint64_t>(2 * yaw_steps + 1) * directions);
      for (int y = -yaw_steps; y <= yaw_steps; ++y) {
        double sum = 0;
        for (const auto& seen : seen_.seen())
          sum +=
              seen.skyline.turned_weight() *
              seen.skyline.turned_loss(skyline_near(seen.place(place_of(best.guess), y * kDegree)), 2 * y, p_.max_rad);
        if (sum < best.cost * total) best.cost = sum / total, best.guess.yaw = y * kDegree;
      }
      places_.push_back(best);
    }
}

}  // namespace odograph::skyline
