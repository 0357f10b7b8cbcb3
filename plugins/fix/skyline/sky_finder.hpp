// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::skyline {

/// Where the sky ends in one direction from the zenith.
struct SkyEdge {
  Eigen::Vector3d ray_c = Eigen::Vector3d::UnitZ();  ///< unit
  bool open = false;   ///< the sky goes on beyond the picture: the edge is here or farther down
  bool above = false;  ///< the picture begins below the edge: it is here or farther up
  double weight = 1;   ///< 0 to 1: how sure the direction is
};

/// Tells sky from the rest in a picture that has the zenith in it, by filling from there over what is smooth (flood
/// fill, as Gakne & O'Keefe 2018, section 3.2), and follows the border of what it filled.
class SkyFinder {
 public:
  static constexpr int kDirections = 720;
  /// Chosen by hand, and not tuned: the paper tells none of them. Pixels are those of half the picture's size.
  struct Parameters {
    double step_rad = 0.15 * std::numbers::pi / 180;  ///< along a direction: a pixel of a phone's wide camera
    double lowest_rad = 1.5;                          ///< from the zenith, that the sky's edge is looked for
    int seed_px = 6;                                  ///< half the width of the patch around the zenith
    double max_noise = 12;                            ///< grey values of contrast there: more is a roof, a tree, a lamp
    double min_contrast = 5;                          ///< grey values, that are smooth in any sky, or ...
    double contrast_by_noise = 2;                     ///< ... so many times the noise, and one
    double min_fill = 2;          ///< grey values from pixel to pixel that the flood crosses, or ...
    double fill_by_noise = 0.75;  ///< ... so many times the noise
    int max_dark_px = 12;         ///< along a direction: less is a lamp, a wire or a bird
    double min_forward = 0.05;    ///< cosine from the optical axis, of rays that a pinhole sees
  };

  SkyFinder(const CameraModel& camera, cv::Size size);
  /// `grey` is 8-bit. `up_c` is the zenith's direction in c (unit), `north_c` any direction across it: the azimuths of
  /// the directions count from there. Empty when the zenith is not in the picture or not in the sky.
  const std::vector<SkyEdge>& find(const cv::Mat& grey, const Eigen::Vector3d& up_c, const Eigen::Vector3d& north_c);
  /// The latest picture's sky, 255, at half its size.
  const cv::Mat& mask() const { return mask_; }

 private:
  bool segment(const cv::Mat& grey, const cv::Point& zenith);

  Parameters p_;
  CameraModel camera_;
  cv::Size size_;
  double widest_tan_;  // of the angle from the optical axis, to where the calibration means something
  cv::Mat small_, low_, high_, contrast_, smooth_, mask_;
  std::vector<SkyEdge> edges_;
};

}  // namespace odograph::skyline
