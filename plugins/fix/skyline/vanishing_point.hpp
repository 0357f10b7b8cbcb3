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
  Eigen::Vector3d normal_c = Eigen::Vector3d::UnitZ();               ///< unit, perpendicular to the rays of both ends
  double length_rad = 0;                                             ///< angle between them
  Eigen::Vector3d from_c = Eigen::Vector3d::UnitZ(), to_c = from_c;  ///< rays of the ends, unit
};

struct VanishingPointParameters {
  double min_length_px = 20;  ///< of a segment; directions of shorter ones have errors above a degree (half a pixel)
  double farthest_rad = 1.4;  ///< from the optical axis: beyond, a fisheye curves lines visibly
  double max_off_rad = 0.10;  ///< max angle between the prior's zenith and the estimate: six degrees
  double first_scale_rad = 0.05;  ///< of the residuals at first, halved each round ...
  double last_scale_rad = 0.006;  ///< ... until this: half a pixel over the shortest segment
  int min_lines = 12;             ///< within the last scale
  double alike = 4;               ///< lines of one wall with a common error; judgement
  double max_sigma_rad = 0.02;    ///< of an accepted zenith
};

/// The zenith in c, unit, and its standard deviation about each perpendicular axis from the lines' residuals. In
/// pictures of Delft half of the errors exceed three of these, because roofs' edges lean alike.
struct SeenZenith {
  Eigen::Vector3d up_c = Eigen::Vector3d::UnitZ();
  double sigma_rad = 0;
  int lines = 0;
};

/// Straight segments of an 8-bit picture (von Gioi et al. 2010) as great circles of rays, without those whose middle
/// the mask excludes (0; it may be empty).
std::vector<SeenLine> lines_of(const cv::Mat& grey, const cv::Mat& mask, const CameraModel& camera,
                               const VanishingPointParameters& parameters);

/// Pitch and roll by the vanishing point of the vertical lines, the edges of houses: after Gallagher 2005, as in Gakne
/// & O'Keefe 2018, but for any lens and with a prior. The great circle of each vertical line contains the zenith; lines
/// are weighted by length, with a robust loss (Geman & McClure 1987). No result where too few lines agree.
std::optional<SeenZenith> vanishing_zenith(const std::vector<SeenLine>& lines, const Eigen::Vector3d& prior_up_c,
                                           const VanishingPointParameters& parameters);

}  // namespace odograph::skyline
