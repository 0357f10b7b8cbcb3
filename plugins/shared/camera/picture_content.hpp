// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace odograph {

/// Visual content of a picture. In a pocket there is only sensor noise, whose corners can be tracked for a few frames
/// but yield a meaningless motion.
struct PictureContent {
  struct Parameters {
    double dark_grey = 8;         ///< mean, of 0 to 255, below which the picture is dark; empirical
    double min_contrast = 1;      ///< grey levels, standard deviation without the noise; empirical
    double min_over_noise = 0.6;  ///< ratio of that variance to the noise variance, in means of 4 x 4 pixels: 0 +- 0.05
                                  ///< in a pocket, 2 to 4 in a street at night (simulated)
  };
  double mean_grey = 0;
  double contrast2 = 0;  ///< variance of the means of 4 x 4 pixels, minus the contribution of independent noise
  double noise2 = 0;     ///< that contribution: a fifteenth of the variance within the blocks

  bool has_content(const Parameters& p) const {
    return mean_grey >= p.dark_grey && contrast2 > p.min_contrast * p.min_contrast &&
           contrast2 > p.min_over_noise * noise2;
  }
};

/// Evaluates an 8-bit grey picture.
PictureContent content_of(const cv::Mat& grey);

}  // namespace odograph
