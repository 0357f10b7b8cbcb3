// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::skyline {

/// The sky's edge in one direction from the zenith.
struct SkyEdge {
  Eigen::Vector3d ray_c = Eigen::Vector3d::UnitZ();  ///< unit
  bool open = false;                                 ///< the sky extends beyond the picture: the edge is here or lower
  bool above = false;                                ///< the picture begins below the edge: the edge is here or higher
  double weight = 1;                                 ///< confidence, 0 to 1
};

/// Finds the sky's edge in a picture that contains the zenith: flood fill over smooth pixels from there (Gakne &
/// O'Keefe 2018, section 3.2), then the border of the filled area.
class SkyFinder {
 public:
  static constexpr int kDirections = 720;
  /// Chosen empirically, not tuned: the paper gives none of them. Pixels are those of the picture at half size.
  struct Parameters {
    double step_rad = 0.15 * std::numbers::pi / 180;  ///< along a direction: a pixel of a phone's wide camera
    double lowest_rad = 1.5;                          ///< max angle of the sky's edge from the zenith
    int seed_px = 6;                                  ///< half the width of the patch around the zenith
    double max_noise = 12;         ///< max contrast there, grey values: more is a roof, a tree, a lamp
    double min_contrast = 5;       ///< grey values of contrast that are smooth in any sky, or ...
    double contrast_by_noise = 2;  ///< ... this multiple of the noise plus one
    double min_fill = 2;           ///< difference of neighbouring pixels that the fill crosses, grey values, or ...
    double fill_by_noise = 0.75;   ///< ... this multiple of the noise
    int max_dark_px = 12;          ///< along a direction: up to this a lamp, a wire or a bird
    double min_forward = 0.05;     ///< min cosine of a pinhole's rays with the optical axis
  };

  SkyFinder(const CameraModel& camera, cv::Size size);
  /// `grey` is 8-bit. `up_c` is the zenith's direction in c (unit), `north_c` any direction perpendicular to it, from
  /// which azimuths are counted. Empty where the zenith is not in the picture or not in the sky.
  const std::vector<SkyEdge>& find(const cv::Mat& grey, const Eigen::Vector3d& up_c, const Eigen::Vector3d& north_c);
  /// Mask of the latest picture's sky (255) at half size.
  const cv::Mat& mask() const { return mask_; }

 private:
  bool segment(const cv::Mat& grey, const cv::Point& zenith);

  Parameters p_;
  CameraModel camera_;
  cv::Size size_;
  double widest_tan_;  // tangent of the max angle from the optical axis for which the calibration is valid
  cv::Mat small_, low_, high_, contrast_, smooth_, mask_;
  std::vector<SkyEdge> edges_;
};

}  // namespace odograph::skyline
