// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/tools/city/photograph_placer.hpp"

namespace odograph {

/// The photograph with the model's roof line over it, as it would lie there from the place that was found.
cv::Mat roofs_over(const cv::Mat& bgr, double focal_px, const PlacedPhotograph& placed, const PhotographPlacer& placer);

/// A photograph on the map: where it was thought to be, and where it is, if it was placed.
struct MappedPhotograph {
  std::string name;
  PhotographGuess guess;
  PlacedPhotograph placed;
};
/// The model's buildings from above, n upwards: guesses as circles of their sigma, places with the heading.
cv::Mat map_of(const std::vector<MappedPhotograph>& photographs, const PhotographPlacer& placer);

}  // namespace odograph
