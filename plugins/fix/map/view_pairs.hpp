// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "plugins/fix/map/picture_features.hpp"
#include "plugins/fix/map/upright_pose.hpp"

namespace odograph::place_map {

/// Further landmarks of a key frame: corners of the query's own detector, matched with those of earlier key frames and
/// triangulated by the known motion. A front-end tracks some fifty to a hundred corners indoors, of which a query from
/// elsewhere shows a third; these are three times as many, and found by the same detector.
struct ViewPairParameters {
  int max_distance = 45;                   ///< Hamming, of a match; motions between key frames are small
  double max_ratio = 0.8;                  ///< of its distance to that of another along the line (Lowe 2004): windows
  double distinct_rad = 0.02;              ///< of one front are alike; nearer corners are the same one
  double epipolar_rad = 0.004;             ///< besides one pixel of the corners' levels
  double lens_rad = 0.002;                 ///< sigma of a ray by a stabiliser's motion, 1 px of 500
  double min_parallax_rad = 0.02;          ///< between the rays: half a metre at 25 m
  double min_range = 0.2, max_range = 60;  ///< metres
  size_t min_common = 8;                   ///< tracked landmarks of both, which give the motion
  double apart_rad = 0.01;                 ///< from landmarks that there are: 4 px of the finest level
  size_t beside = 3;                       ///< tracked landmarks nearest to a corner in the picture, ...
  double deeper = 1.6;  ///< beyond whose distances it is by this factor at most: no window for another
};

/// The corners of a key frame, with the ids of those that are landmarks (0: not).
struct CornerView {
  uint64_t key_frame = 0;
  uint32_t epoch = 0;
  Eigen::Vector3d down_c = Eigen::Vector3d::UnitY();
  std::vector<Feature> features;
  std::vector<uint64_t> ids;
  std::vector<std::pair<uint64_t, Eigen::Vector3d>> tracked;  ///< rays of the front-end's landmarks, by id
};

/// The motion between two views in which the landmarks that both track are where they were seen: a published
/// orientation is not exact to the parallax of a short way.
struct ViewMotion {
  Rigid T_o_c;            ///< from the newer view to the older one
  double rotation_sigma;  ///< about each axis
};
/// Nothing if they track too few in common.
std::optional<ViewMotion> motion_between(const CornerView& view, std::span<const Landmark> landmarks,
                                         const CornerView& older, const Rigid& T_o_c, const PoseParameters& pose,
                                         size_t fewest);

/// Whether a point is about as far as the tracked landmarks beside it in the picture.
bool is_as_far(const Eigen::Vector3d& p_c, std::span<const Landmark> tracked, const ViewPairParameters& parameters);

/// A corner of a new view as a landmark.
struct PairedCorner {
  size_t feature;  ///< of the new view
  uint64_t id;     ///< of the older view's landmark, 0 if it is new
  size_t older;    ///< feature of the older view
  Eigen::Vector3d p_c;
  double across_sigma, along_sigma;
};
std::vector<PairedCorner> pair_corners(const CornerView& view, const CornerView& older, const ViewMotion& motion,
                                       const ViewPairParameters& parameters);

}  // namespace odograph::place_map
