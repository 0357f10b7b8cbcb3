// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

namespace odograph {

/// A ray seen by a camera at a known pose.
struct Sighting {
  Eigen::Isometry3d T_w_c;
  cv::Point2d normalized;
};

/// Relative pose of two views: five-point RANSAC (Nister 2004), then Gauss-Newton on the Sampson error of the inliers
/// (Hartley & Zisserman 2003, section 11.4.3) with Huber weights, over rotation and direction of translation.
struct TwoView {
  Eigen::Matrix3d R_1_0;           ///< takes vectors from the first camera to the second
  Eigen::Vector3d t_1_0;           ///< unit length; x_1 = R_1_0 x_0 + t_1_0
  std::vector<char> inliers;       ///< of the matches; in front of both cameras
  int count = 0;                   ///< of inliers
  double median_parallax_rad = 0;  ///< angle between the rays after rotation compensation
};

/// Thresholds of the two-view estimation; empirical, not tuned.
struct TwoViewParameters {
  size_t min_matches = 12;        ///< also of inliers: five are needed, fewer than twelve may agree by chance
  double confidence = 0.9999;     ///< of RANSAC: probability of a sample without outliers
  double farthest = 1e5;          ///< baselines: farther points do not distinguish the four poses
  double huber_part = 0.5;        ///< of the threshold, beyond which the loss is linear in the refinement
  double first_bound = 4;         ///< thresholds, for the matches of a candidate direction in the first
  double second_bound = 1.5;      ///< and second refinement
  double same_direction = 0.94;   ///< cosine of 20 degrees: directions closer than that are the same
  double ambiguous_ratio = 1.15;  ///< ratio of another direction's cost to the best: below it the result is ambiguous
};

/// Pure rotation that best explains the matches, and the median residual angle, that is, the parallax. Unlike an
/// essential matrix it is well defined without parallax. Nothing with too few matches.
struct PureRotation {
  Eigen::Matrix3d R_1_0;
  double median_residual_rad;
};
std::optional<PureRotation> pure_rotation(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                                          const TwoViewParameters& parameters = {});

/// Nothing with too few matches. `threshold` in normalized coordinates.
std::optional<TwoView> two_view(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                                double threshold, int trials = 1000, const TwoViewParameters& parameters = {});

/// The same for little parallax and an approximately known rotation: besides the RANSAC result several directions of
/// the translation are tried, each refined with the rotation over all matches with a bounded loss. Also nothing if a
/// clearly different direction explains the matches nearly as well, that is, the motion is still ambiguous.
std::optional<TwoView> two_view_near(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                                     const Eigen::Matrix3d& R_1_0, double threshold, int trials,
                                     const TwoViewParameters& parameters = {});

/// The point nearest to all rays, refined by two Gauss-Newton steps on the reprojection error; nothing if it lies
/// behind a camera, its largest error exceeds `threshold`, or the rays are less than `min_parallax_rad` apart.
std::optional<Eigen::Vector3d> triangulate(const std::vector<Sighting>& sightings, double threshold,
                                           double min_parallax_rad);

}  // namespace odograph
