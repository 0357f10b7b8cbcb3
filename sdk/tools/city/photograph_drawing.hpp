// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/tools/city/photograph_localizer.hpp"

namespace odograph {

/// Draws the model's roof line at the estimated pose over the photograph.
void draw_roofs(cv::Mat& bgr, double focal_px, const PhotographPose& placed, const PhotographLocalizer& placer);

/// A photograph on the map: the prior position, and the estimate if it was placed.
struct MappedPhotograph {
  std::string name;
  PhotographGuess guess;
  PhotographPose placed;
};
/// The model's edges from above, north up, with a legend: priors and estimates as circles of one sigma.
cv::Mat map_of(const std::vector<MappedPhotograph>& photographs, const PhotographLocalizer& placer);

}  // namespace odograph
