// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/tools/plot/plot.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// A run of one recording under a name that a legend can show.
struct NamedRun {
  std::string name;
  const RunResult* result;
};

/// Distance of each pose from the truth over the seconds since the first pose, m: after the rotation about the vertical
/// and the shift that fit best (with a scale where the track is not metric); without a truth at the waypoints, the
/// track turned and shifted onto the first 10 m of them. Empty where a recording has neither.
std::vector<std::pair<double, double>> error_over_time(const Recording& recording, const RunResult& result);

/// Tracks beside truth, waypoints and fixes; error over time and its distribution; step lengths; scale with its sigma;
/// modes and states over time; what fixes differ from the track by. Only plots that have something to show.
std::vector<Plot> plots_of(const Recording& recording, const std::vector<NamedRun>& runs);

namespace html {

/// Text with what HTML takes for markup made harmless.
std::string escape(const std::string& text);
std::string fixed(double value, int digits);
/// The start of a page that is good on paper too, up to its heading.
std::string head(const std::string& title);
/// The plots one after the other, or why there are none.
std::string figures(const std::vector<Plot>& plots);

}  // namespace html
}  // namespace odograph
