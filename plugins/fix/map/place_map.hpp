// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "plugins/fix/map/verification.hpp"
#include "plugins/fix/map/view_pairs.hpp"
#include "plugins/fix/map/word_index.hpp"

namespace odograph::place_map {

struct PlaceMapParameters {
  FeatureParameters features;
  PoseParameters pose;
  VerificationParameters verification;
  ViewPairParameters pairs;
  size_t paired_views = 2;     ///< earlier key frames with which landmarks are triangulated
  int vote_distance = 60;      ///< Hamming, of a descriptor that votes for its key frame
  size_t candidates = 6;       ///< key frames that are verified
  size_t neighbours = 3;       ///< key frames beside a candidate whose landmarks are added
  size_t max_looks = 4;        ///< descriptors of a landmark, from several key frames
  double neighbour_m = 1.5;    ///< largest distance of a neighbour
  double neighbour_rad = 0.6;  ///< and of its direction of view
  size_t max_landmarks = 250;  ///< of a key frame
  double max_sigma = 0.15;     ///< of a landmark's distance, relative
  double min_log_odds = 20;    ///< of a place against chance, to be plausible,
  double sure_log_odds = 40;   ///< and to be accepted: the look-alikes of 3,696 views had up to 29 (README)
  double min_share = 0.16;     ///< of the landmarks that should be seen and are: look-alikes agree in parts
  int min_cells = 8;           ///< of the picture with inliers: spread over it, not one object
  double min_covered = 0.6;    ///< of the cells with landmarks: wrong poses agree in parts of the picture
  int min_off_plane = 4;       ///< cells with matches off the plane of most: flat pictures, fronts, doors have copies
  double max_runner_up = 0.5;  ///< log odds of the best other place, relative: look-alikes within the map
  double same_place_m = 1, same_place_rad = 0.35;  ///< poses in the map that are farther apart are other places
  double focal_sigma = 0.005;                      ///< relative, of the lens: the distance to what is seen
  double rotation_floor_rad = 0.003, position_floor_m = 0.005;  ///< of lens and shutter
};

/// Key frames with their landmarks, and the recognition of pictures among them. Not thread-safe, except that several
/// threads may call const methods.
class PlaceMap {
 public:
  /// Key frames that recognise() must not use.
  using Excludes = std::function<bool(const KeyFrame&)>;

  PlaceMap() = default;
  explicit PlaceMap(const PlaceMapParameters& parameters) : p_(parameters) {}

  /// Adds a key frame and returns its id, not 0; 0 if too few landmarks can be described.
  uint64_t add(const Picture& picture, std::span<const Landmark> landmarks, const Rigid& T_m_c, uint32_t epoch = 0,
               double scale_sigma = 0.02);
  void set_pose(uint64_t id, const Rigid& T_m_k);
  void remove(uint64_t id);
  /// Removes key frames until the map has at most that size: each time the one that another is nearest to, in place and
  /// direction, the older of the two.
  void thin(size_t bytes);
  /// The same until it has so many.
  void keep(size_t count);
  /// Replaces all key frames, whose ids increase.
  void restore(std::vector<KeyFrame> frames);
  /// Larger than the epoch of any key frame.
  uint32_t next_epoch() const;
  const KeyFrame* find(uint64_t id) const;
  const std::vector<KeyFrame>& key_frames() const { return frames_; }
  size_t bytes() const;

  std::optional<Recognition> recognise(const Picture& picture, const Excludes& excludes = {}) const;

  /// A candidate that was verified; for figures.
  struct Candidate {
    size_t frame;  ///< index into key_frames()
    double votes;
    std::optional<Verified> verified;
  };
  /// The candidates of a view (view_of), the one with the best evidence first.
  std::vector<Candidate> candidates(const QueryView& query, const Excludes& excludes = {}) const;
  /// The best of the candidates, with its log odds and those of the best other place, whether accepted or not.
  std::optional<Recognition> best_of(const QueryView& query, const std::vector<Candidate>& candidates) const;
  bool is_accepted(const Recognition& r) const { return is_strong(r) && r.off_plane >= p_.min_off_plane; }
  /// Less: what is seen may be nearly flat, of which other places may have copies.
  bool is_strong(const Recognition& r) const {
    return is_plausible(r) && r.log_odds > p_.sure_log_odds && r.covered > p_.min_covered;
  }
  /// Still less: to be used only where odometry or another fix predicts the pose as well.
  bool is_plausible(const Recognition& recognition) const;

  const PlaceMapParameters& parameters() const { return p_; }

 private:
  struct Owner {
    uint32_t frame;
    uint16_t landmark;
    uint16_t look;
  };

  void add_tracked(const PictureLevels& levels, std::span<const Landmark> landmarks, KeyFrame& frame) const;
  void add_rays(const Picture& picture, std::span<const Landmark> landmarks, CornerView& view) const;
  void add_paired(const PictureLevels& levels, std::span<const Landmark> landmarks, CornerView& view, KeyFrame& frame);
  void index(size_t frame);
  void rebuild();
  double log_odds(const Candidate& candidate) const;
  void set_covariance(const Candidate& candidate, Recognition& recognition) const;
  std::vector<double> votes(const std::vector<Feature>& features, const std::vector<char>& excluded) const;
  std::vector<size_t> beside(size_t frame, const std::vector<char>& excluded) const;
  LocalMap local_map(size_t frame, const std::vector<char>& excluded) const;

  PlaceMapParameters p_;
  std::vector<KeyFrame> frames_;
  WordIndex words_;
  std::vector<Owner> owners_;       // by number of the descriptor
  std::vector<CornerView> recent_;  // the last key frames, the newest first
  uint64_t last_id_ = 0, last_paired_ = 0;
};

}  // namespace odograph::place_map
