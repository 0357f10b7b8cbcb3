// SPDX-License-Identifier: Apache-2.0
//
// Pose of a calibrated camera from landmarks that it sees, with gravity known in both frames: two-point RANSAC over yaw
// and position, then least squares over all six unknowns with gravity as a measurement.
#pragma once

#include <optional>
#include <vector>

#include "plugins/fix/map/place_types.hpp"

namespace odograph::place_map {

/// A ray of the picture that may show a landmark.
struct Correspondence {
  Eigen::Vector3d p_k;                       ///< of the landmark
  double across_sigma = 0, along_sigma = 0;  ///< across and along the ray from k, metres
  Eigen::Vector3d ray_c;                     ///< unit vector
  double sigma_rad = 0;                      ///< of the ray, about each axis
  double zoom = 1;   ///< how much larger the landmark appears than in k, by the levels of the descriptors; 0: not known
  int distance = 0;  ///< Hamming
  double confidence = 1;             ///< probability that it is right, by its descriptors alone
  size_t landmark = 0, feature = 0;  ///< indices of the caller
  uint64_t id = 0;                   ///< of the landmark
};

struct Gravity {
  Eigen::Vector3d down_k, down_c;
  double sigma_rad;  ///< of both together
};

struct PoseParameters {
  int trials = 1000;            ///< of RANSAC: 99.99 % with one inlier in ten
  double gate = 9.21;           ///< squared Mahalanobis distance of an inlier: 99 % of two degrees of freedom
  double lens_rad = 1e-3;       ///< sigma of a ray by lens and shutter: half a pixel of 500
  double max_zoom_error = 1.6;  ///< between the zoom by levels and by distances; levels are 1.26 apart
  int iterations = 5;           ///< of least squares
};

/// Squared Mahalanobis distance of a correspondence and the area of its unit ellipse, sr. `T`: from k to c;
/// `further_sigma_rad`: of the prediction in common.
struct Residual {
  double squared;
  double area_sr;
};
Residual residual_of(const Correspondence& match, const Rigid& T_c_k, double lens_rad, double further_sigma_rad);

/// Poses T_c_k in which two landmarks lie on their rays: none, one or two (Kukelova et al. 2010). Frames whose z axes
/// point along gravity.
std::vector<Rigid> two_point_poses(const Eigen::Vector3d& X0, const Eigen::Vector3d& X1, const Eigen::Vector3d& ray0,
                                   const Eigen::Vector3d& ray1);

struct RefinedPose {
  Rigid T_c_k;
  Eigen::Matrix<double, 6, 6> information;  ///< of (rotation, position) of T_c_k, left perturbation
};
/// Weighted least squares over the given correspondences, all taken as inliers with Huber weights.
std::optional<RefinedPose> refine_pose(const std::vector<Correspondence>& matches, const Gravity& gravity,
                                       const Rigid& T_c_k, const PoseParameters& parameters);

struct RansacPose {
  Rigid T_c_k;
  std::vector<size_t> inliers;  ///< indices of the correspondences
};
/// The pose with which most correspondences agree; `matches` begin with the most distinctive. Deterministic.
std::optional<RansacPose> ransac_pose(const std::vector<Correspondence>& matches, const Gravity& gravity,
                                      const PoseParameters& parameters);

}  // namespace odograph::place_map
