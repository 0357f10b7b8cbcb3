// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/tools/city/photograph_localizer.hpp"

namespace odograph {

/// The photograph with the model's roof line at the estimated pose drawn over it.
cv::Mat roofs_over(const cv::Mat& bgr, double focal_px, const PhotographPose& placed,
                   const PhotographLocalizer& placer);

/// A photograph on the map: the prior position, and the estimate if it was placed.
struct MappedPhotograph {
  std::string name;
  PhotographGuess guess;
  PhotographPose placed;
};
/// The model's buildings from above, north up: priors as circles of their sigma, estimates with the heading.
cv::Mat map_of(const std::vector<MappedPhotograph>& photographs, const PhotographLocalizer& placer);

}  // namespace odograph
