// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace odograph::vio {

/// Template of a corner from the picture in which it was found, matched in later pictures under an affine map and a
/// change of light. An approached surface grows and a passed one is foreshortened, which would pull a purely translated
/// window off its corner. Inverse compositional Lucas-Kanade (Baker & Matthews 2004, sections 3.2 and 4.2) with
/// brightness and contrast projected out.
class Patch {
 public:
  static constexpr int kSide = 15, kPixels = kSide * kSide;

  struct Parameters {
    int iterations = 12;
    double settled_px = 0.01;    ///< convergence threshold of the shift
    double grey_sigma = 2;       ///< noise of a pixel, grey levels, against
    double affine_sigma = 0.03;  ///< the prior of the map's change from frame to frame
    double min_contrast = 2;     ///< grey levels, standard deviation
    double min_gradient = 1;     ///< smallest root mean square of the gradient in any direction, grey levels per px
  };

  /// Present position of the patch: pixel = at + A (offset from the corner, px).
  struct Map {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    Eigen::Matrix2d A = Eigen::Matrix2d::Identity();
  };
  struct Match {
    Map map;
    double difference = 0;  ///< grey levels of the first picture, mean
  };

  /// Stores the neighbourhood of `at` in an 8-bit picture. False at the border or without texture.
  bool store(const cv::Mat& picture, const Eigen::Vector2d& at, const Parameters& p);

  /// Searches from `guess`. Nothing if it leaves the picture or does not converge.
  std::optional<Match> find(const cv::Mat& picture, const Map& guess, const Parameters& p) const;

 private:
  using Values = Eigen::Matrix<float, kPixels, 1>;

  Values values_;                                 ///< mean removed
  Eigen::Matrix<float, kPixels, 6> derivatives_;  ///< by A (column-major) and at; brightness and contrast projected out
  Eigen::Matrix<double, 6, 6> H_;
  double contrast_ = 0;  ///< standard deviation
};

}  // namespace odograph::vio
