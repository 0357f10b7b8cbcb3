// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace odograph::vio {

/// The neighbourhood of a corner as it looked where it was found, to be found again in later pictures under an affine
/// map and a change of light: what a camera comes nearer to grows, and what it passes is foreshortened, so that a
/// window that may only be shifted is drawn away from its corner. Inverse compositional Lucas-Kanade (Baker & Matthews
/// 2004, sections 3.2 and 4.2), brightness and contrast projected out.
class Patch {
 public:
  static constexpr int kSide = 15, kPixels = kSide * kSide;

  struct Parameters {
    int iterations = 12;
    double settled_px = 0.01;    ///< last shift of a map that has been found
    double grey_sigma = 2;       ///< grey levels of a pixel's noise: against
    double affine_sigma = 0.03;  ///< the change of the map from frame to frame
    double min_contrast = 2;     ///< grey levels, standard deviation
    double min_gradient = 1;     ///< smallest root mean square of the gradient in any direction, grey levels per px
  };

  /// Where the patch is now: pixel = at + A (offset from the corner, px).
  struct Map {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    Eigen::Matrix2d A = Eigen::Matrix2d::Identity();
  };
  struct Match {
    Map map;
    double difference = 0;  ///< grey levels of the first picture, mean
  };

  /// Remembers the surroundings of `at` in an 8-bit picture. False at the border and where nothing is to be seen.
  bool remember(const cv::Mat& picture, const Eigen::Vector2d& at, const Parameters& p);

  /// From `guess`. Nothing where it runs out of the picture or does not settle.
  std::optional<Match> find(const cv::Mat& picture, const Map& guess, const Parameters& p) const;

 private:
  using Values = Eigen::Matrix<float, kPixels, 1>;

  Values values_;                                 ///< without their mean
  Eigen::Matrix<float, kPixels, 6> derivatives_;  ///< by A (by columns) and at; without what light could explain
  Eigen::Matrix<double, 6, 6> H_;
  double contrast_ = 0;  ///< standard deviation
};

}  // namespace odograph::vio
