// SPDX-License-Identifier: Apache-2.0
//
// Whether a picture shows a candidate place, and from where: matches, pose, and the evidence for and against it.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "plugins/fix/map/picture_features.hpp"
#include "plugins/fix/map/upright_pose.hpp"

namespace odograph::place_map {

struct VerificationParameters {
  int max_distance = 72;             ///< Hamming, of a match: chance comes so near in 1e-4 of pairs (bench)
  double guided_rad = 0.004;         ///< sigma of a predicted ray in common, by lens and scale: 2 px of 500
  double max_view_angle_rad = 0.87;  ///< between the directions of view of a landmark: 50 degrees
  double max_zoom = 2.5;             ///< by which a landmark may appear larger or smaller
  double cell_rad = 0.1;  ///< side of a cell of the picture, whose matches count as one: patches overlap in it
  /// Of the plane through most matches, relative to a landmark's distance, besides three of its sigmas.
  double plane_part = 0.03;
  double distinct_rad = 0.05;  ///< between a match and another that might be taken for it
  /// Ratio of a match's distance to that of the second best (Lowe 2004) at which half are right, and the width of the
  /// logistic function: simulated hall, seed 1.
  double even_ratio = 0.72, ratio_width = 0.06;
};

/// A landmark of a place: of the candidate key frame or of one beside it.
struct LocalLandmark {
  uint64_t id;
  Eigen::Vector3d p_k;
  double across_sigma, along_sigma;
  Eigen::Vector3d seen_along_k;  ///< unit vector from the camera that described it
  double seen_from_m;            ///< its distance then
  struct Look {
    Descriptor descriptor;
    int level;
    double distance_m;  ///< from where it was described
  };
  std::vector<Look> looks;
};
using LocalMap = std::vector<LocalLandmark>;

/// What speaks for a place.
struct Evidence {
  int tentative = 0;      ///< matches by descriptor
  int inliers = 0;        ///< of them
  int inlier_cells = 0;   ///< cells of the picture with inliers
  int visible = 0;        ///< landmarks that should be in the picture
  int matched = 0;        ///< of them, found where they should be
  int cells = 0;          ///< cells of the picture with such
  int off_plane = 0;      ///< cells with matches that are not on the plane of most of them
  double covered = 0;     ///< share of the cells with three or more visible landmarks in which one is found
  double log_chance = 0;  ///< logarithm of the expected number of such agreements by chance (Moisan & Stival 2004)
};

struct Verified {
  Rigid T_c_k;
  Eigen::Matrix<double, 6, 6> information;
  Evidence evidence;
  std::vector<Correspondence> matches;
  Eigen::Vector3d normal_k = Eigen::Vector3d::Zero();  ///< of the plane of most of them
};

/// The query's side of a verification: a picture, or a key frame of another map.
struct QueryView {
  int64_t t_ns = 0;
  Eigen::Vector3d down_c = Eigen::Vector3d::UnitY();
  double tilt_sigma_rad = 0;
  std::vector<Feature> features;
  double area_sr = 0;                                 ///< of the picture
  std::function<bool(const Eigen::Vector3d&)> shows;  ///< whether a point, in c, is in the picture
};
/// The features of a picture, which must outlive the view.
QueryView view_of(const Picture& picture, const FeatureParameters& parameters);
/// The landmarks of a key frame as features. Of its picture nothing is kept: what they span counts as the picture.
QueryView view_of(const KeyFrame& frame, const FeatureParameters& parameters);

std::optional<Verified> verify(const QueryView& query, const LocalMap& map, const Gravity& gravity,
                               const PoseParameters& pose, const VerificationParameters& parameters,
                               const FeatureParameters& features);

}  // namespace odograph::place_map
