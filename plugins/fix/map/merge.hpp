// SPDX-License-Identifier: Apache-2.0
//
// Maps of one place become one map.
#pragma once

#include "plugins/fix/map/place_map.hpp"

namespace odograph::place_map {

/// Key frames of several maps in one frame. Those beside one of an earlier map are left out: it shows the same.
class JoinedFrames {
 public:
  /// `T_j_m`: from the map's frame to the common one.
  void add(const PlaceMap& map, const Rigid& T_j_m);
  std::vector<KeyFrame> take() { return std::move(frames_); }

 private:
  static constexpr double kKnown_m = 0.3, kKnown_rad = 0.2;  // so near is beside
  std::vector<KeyFrame> frames_;
  uint32_t epochs_ = 0;  // landmark ids of different maps are unrelated
};

struct PlacingParameters {
  size_t max_asked = 400;      ///< key frames of each map that are looked up in the other, evenly chosen
  size_t fewest = 3;           ///< key frames of one map that must agree; at least one is accepted by itself
  double agree_m = 0.3;        ///< difference of their places that agrees,
  double agree_part = 0.05;    ///< and with the distance between them: the drift of both maps
  double agree_rad = 0.1;      ///< difference of their headings
  double beside_m = 0.7;       ///< a key frame so near one of the other map, ...
  double beside_rad = 0.35;    ///< with such a view, should be recognised
  double min_share = 0.2;      ///< of such, those that agree
  double max_runner_up = 0.5;  ///< key frames that agree on another place, relative
};

/// Where another map lies in a map, by the key frames of each that are recognised in the other. A look-alike, such as
/// the same front elsewhere in a street, is recognised from one key frame or two, while those beside it are not.
struct Placed {
  Rigid T_m_o;         ///< a turn about the vertical and a shift: both maps are levelled
  double sigma_m = 0;  ///< of a key frame's place in the map with it, in each axis
  size_t asked = 0, recognised = 0, agreeing = 0, beside = 0, runner_up = 0;  ///< key frames of both
  bool is_found = false;
};
Placed place_of(const PlaceMap& other, const PlaceMap& map, const PlacingParameters& parameters = {});

}  // namespace odograph::place_map
