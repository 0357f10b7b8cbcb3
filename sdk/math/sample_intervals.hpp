// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace odograph {

/// Number of samples later than t_ns. `Samples` has the interface of Ring: size(), and back(i) from the newest to the
/// oldest, each with a distinct t_ns.
template <class Samples>
size_t count_after(const Samples& samples, int64_t t_ns) {
  size_t low = 0, high = samples.size();  // samples [0, low) are later
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (samples.back(middle).t_ns > t_ns)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/// Calls `visit(before, after, t0_ns, t1_ns)` in time order for each part [t0_ns, t1_ns] of [from_ns, to_ns] between
/// two neighbouring samples; before the oldest and after the newest sample, both arguments are that sample. Returns
/// false if the interval contains more than `longest_gap_ns` without a sample; if that gap is at either end, nothing is
/// visited.
template <class Samples, class Visit>
bool for_each_interval(const Samples& samples, int64_t from_ns, int64_t to_ns, int64_t longest_gap_ns, Visit visit) {
  const size_t n = samples.size();
  if (n == 0 || from_ns + longest_gap_ns < samples.back(n - 1).t_ns || to_ns - longest_gap_ns > samples.back(0).t_ns)
    return false;
  bool whole = true;
  size_t later = count_after(samples, from_ns);
  for (int64_t t_ns = from_ns; t_ns < to_ns;) {
    const auto& before = samples.back(std::min(later, n - 1));
    const auto& after = samples.back(later > 0 ? --later : 0);
    const int64_t until_ns = after.t_ns > t_ns ? std::min(after.t_ns, to_ns) : to_ns;
    whole = whole && until_ns - t_ns <= longest_gap_ns;
    visit(before, after, t_ns, until_ns);
    t_ns = until_ns;
  }
  return whole;
}

}  // namespace odograph
