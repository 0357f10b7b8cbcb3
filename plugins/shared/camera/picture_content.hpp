// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace odograph {

/// What there is to be seen in a picture: in a pocket it is the sensor's noise, whose corners can be followed for a few
/// frames and whose motion is fiction.
struct PictureContent {
  struct Parameters {
    double dark_grey = 8;         ///< mean, of 0 to 255, below which there is nothing; by hand
    double min_contrast = 1;      ///< grey levels, standard deviation of what is not noise; by hand
    double min_over_noise = 0.6;  ///< variance of that over the noise's, in means of 4 x 4 pixels: 0 +- 0.05 in a
                                  ///< pocket, 2 to 4 in a street by night (simulated)
  };
  double mean_grey = 0;
  double contrast2 = 0;  ///< variance of the means of 4 x 4 pixels, less what independent noise makes of it
  double noise2 = 0;     ///< and that: a fifteenth of the variance within them

  bool shows_something(const Parameters& p) const {
    return mean_grey >= p.dark_grey && contrast2 > p.min_contrast * p.min_contrast &&
           contrast2 > p.min_over_noise * noise2;
  }
};

/// Of an 8-bit grey picture.
PictureContent content_of(const cv::Mat& grey);

}  // namespace odograph
