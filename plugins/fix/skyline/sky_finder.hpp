// SPDX-License-Identifier: Apache-2.0
#pragma once

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

  SkyFinder(const CameraModel& camera, cv::Size size);
  /// `grey` is 8-bit. `up_c` is the zenith's direction in c (unit), `north_c` any direction across it: the azimuths of
  /// the directions count from there. Empty when the zenith is not in the picture or not in the sky.
  const std::vector<SkyEdge>& find(const cv::Mat& grey, const Eigen::Vector3d& up_c, const Eigen::Vector3d& north_c);
  /// The latest picture's sky, 255, at half its size.
  const cv::Mat& mask() const { return mask_; }

 private:
  bool segment(const cv::Mat& grey, const cv::Point& zenith);

  CameraModel camera_;
  cv::Size size_;
  double widest_tan_;  // of the angle from the optical axis, to where the calibration means something
  cv::Mat small_, low_, high_, contrast_, smooth_, mask_;
  std::vector<SkyEdge> edges_;
};

}  // namespace odograph::skyline
