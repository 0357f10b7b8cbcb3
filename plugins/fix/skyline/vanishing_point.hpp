// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::skyline {

/// The great circle of a straight line in a picture.
struct SeenLine {
  Eigen::Vector3d normal_c = Eigen::Vector3d::UnitZ();  ///< unit, across the rays of both ends
  double length_rad = 0;                                ///< between them
};

struct VanishingPointParameters {
  double min_length_px = 20;  ///< of a segment; shorter ones' directions are off by more than a degree (half a pixel)
  double farthest_rad = 1.4;  ///< from the optical axis: beyond it a fisheye bends lines within their length
  double max_off_rad = 0.10;  ///< between the prior's zenith and the one looked for: six degrees
  double first_scale_rad = 0.05;  ///< of the residuals at first, halved each round ...
  double last_scale_rad = 0.006;  ///< ... until this: half a pixel over the shortest segment
  int min_lines = 12;             ///< within the last scale
  double alike = 4;               ///< so many lines are edges of one wall, and err together; judgement
  double max_sigma_rad = 0.02;    ///< of a zenith that is told
};

/// The zenith in c, unit, and its standard deviation about each axis across it as the lines' residuals have it: in
/// pictures of Delft half of the errors are beyond three of these, because roofs' edges lean alike.
struct SeenZenith {
  Eigen::Vector3d up_c = Eigen::Vector3d::UnitZ();
  double sigma_rad = 0;
  int lines = 0;
};

/// Straight segments of an 8-bit picture (von Gioi et al. 2010) as great circles of rays.
std::vector<SeenLine> lines_of(const cv::Mat& grey, const CameraModel& camera,
                               const VanishingPointParameters& parameters);

/// Pitch and roll by the vanishing point of the upright lines, which are the edges of houses: after Gallagher 2005,
/// whom Gakne & O'Keefe 2018 follow, with every lens and a prior. Each line's circle goes through the zenith; weights
/// by length, robust (Geman & McClure 1987). None where too few lines agree.
std::optional<SeenZenith> vanishing_zenith(const std::vector<SeenLine>& lines, const Eigen::Vector3d& prior_up_c,
                                           const VanishingPointParameters& parameters);

}  // namespace odograph::skyline
