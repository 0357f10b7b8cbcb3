// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "plugins/fix/map/picture_features.hpp"

namespace odograph::place_map {

/// Further landmarks of a key frame: corners of the query's own detector, matched with those of earlier key frames and
/// triangulated by the known motion. A front-end tracks some fifty to a hundred corners indoors, of which a query from
/// elsewhere shows a third; these are three times as many, and found by the same detector.
struct ViewPairParameters {
  int max_distance = 45;                   ///< Hamming, of a match; motions between key frames are small
  double epipolar_rad = 0.004;             ///< besides one pixel of the corners' levels
  double lens_rad = 0.002;                 ///< sigma of a ray by a stabiliser's motion, 1 px of 500
  double min_parallax_rad = 0.02;          ///< between the rays: half a metre at 25 m
  double min_range = 0.2, max_range = 60;  ///< metres
  double apart_rad = 0.01;                 ///< from landmarks that there are: 4 px of the finest level
};

/// The corners of a key frame, with the ids of those that are landmarks (0: not).
struct CornerView {
  uint64_t key_frame = 0;
  uint32_t epoch = 0;
  std::vector<Feature> features;
  std::vector<uint64_t> ids;
};

/// A corner of a new view as a landmark.
struct PairedCorner {
  size_t feature;  ///< of the new view
  uint64_t id;     ///< of the older view's landmark, 0 if it is new
  size_t older;    ///< feature of the older view
  Eigen::Vector3d p_c;
  double across_sigma, along_sigma;
};
/// `T_c_o`: from the older view to the new one.
std::vector<PairedCorner> pair_corners(const CornerView& view, const CornerView& older, const Eigen::Quaterniond& q_c_o,
                                       const Eigen::Vector3d& p_c_o, const ViewPairParameters& parameters);

}  // namespace odograph::place_map
