// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/offset_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace odograph::skyline {

int OffsetMap::average(std::vector<Place>& places, double step_m) {
  const auto cell = [&](double m) { return static_cast<int>(std::lround(m / step_m)); };
  int reach = 0;
  for (const Place& p : places) reach = std::max({reach, std::abs(cell(p.guess.north)), std::abs(cell(p.guess.east))});
  constexpr float unknown = std::numeric_limits<float>::infinity();
  const int old_reach = pictures_ > 0 ? reach_ : -1;
  before_ = means_;
  const auto old = [&](int a, int b) {
    if (std::max(std::abs(a), std::abs(b)) > old_reach) return unknown;
    return before_[static_cast<size_t>((a + old_reach) * (2 * old_reach + 1) + b + old_reach)];
  };
  means_.assign(static_cast<size_t>((2 * reach + 1) * (2 * reach + 1)), unknown);
  for (Place& p : places) {
    const int a = cell(p.guess.north), b = cell(p.guess.east);
    float past = old(a, b);
    for (int da = -1; da <= 1; ++da)
      for (int db = -1; db <= 1; ++db) past = std::min(past, old(a + da, b + db) + static_cast<float>(p_.slip_rad));
    if (past < unknown) p.cost = p_.newest * p.cost + (1 - p_.newest) * static_cast<double>(past);
    means_[static_cast<size_t>((a + reach) * (2 * reach + 1) + b + reach)] = static_cast<float>(p.cost);
  }
  reach_ = reach;
  return ++pictures_;
}

}  // namespace odograph::skyline
