// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "plugins/step/odograph/gait_finder.hpp"

namespace odograph::steps {

/// Steps that GaitFinder finds in samples at 100 Hz until `end_s`; `at` gives the sample of a time, s.
template <class At>
std::vector<FoundStep> found_gait(double end_s, At&& at) {
  Resampler resampler;
  GaitFinder finder;
  std::vector<FoundStep> steps;
  for (double t = 0; t < end_s; t += 0.01) {
    WalkSample sample = at(t);
    sample.t_ns = static_cast<int64_t>(t * 1e9);
    resampler.push(
        sample,
        [&](const WalkSample& s) {
          finder.add(s);
          for (const FoundStep& step : finder.found()) steps.push_back(step);
        },
        [&] { finder.reset(); });
  }
  return steps;
}

}  // namespace odograph::steps
