// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/vo/odograph/visual/gyroscope.hpp"
#include "plugins/vo/odograph/visual/pose_fit.hpp"

namespace odograph::vo {

struct Keyframe {
  uint32_t id;
  int64_t t_ns;
  Eigen::Isometry3d T_w_c;
  std::optional<GyroRotation> rotation;  ///< from the previous keyframe, with the bias at that time
  Eigen::Vector3d rotation_bias_c;
};

struct Observation {
  uint32_t keyframe;
  Eigen::Vector2d seen;  ///< normalized
};

/// A point in its first keyframe of the window: a ray, and the inverse depth along z (Civera et al. 2008).
struct Landmark {
  std::vector<Observation> seen;  ///< the first is the anchor
  double inverse_depth = 0, variance = 0;
  bool triangulated = false;  ///< the depth is valid
  int misses = 0;
};

/// The latest keyframes and their observations.
class Window {
 public:
  explicit Window(const KeyframeParameters& parameters) : p_(parameters) {}

  void clear();
  void add(Keyframe keyframe);
  /// Removes the newest keyframe with its observations: the next one replaces it.
  void drop_newest();
  void observe(uint64_t track, const Eigen::Vector2d& seen);  ///< by the newest keyframe
  /// Triangulates the points that have gained parallax; the others stay unlocated.
  void triangulate();
  /// Removes the oldest keyframes beyond the window; their points get the next observing keyframe as anchor.
  void slide();
  void remove_landmark(uint64_t track) { landmarks_.erase(track); }
  void remove_untracked(const std::vector<uint64_t>&
                            alive);  ///< removes points with fewer than two observations that are no longer tracked

  Eigen::Vector4d point(const Landmark& landmark) const;  ///< in w, homogeneous
  Eigen::Vector3d anchor(const Landmark& landmark) const {
    return keyframe(landmark.seen.front().keyframe).T_w_c.translation();
  }
  /// Variance of each inverse depth from its observations, with the poses fixed.
  void update_depth_variance(double sigma);
  double depth_median() const;
  size_t triangulated() const;

  std::deque<Keyframe>& keyframes() { return keyframes_; }
  const std::deque<Keyframe>& keyframes() const { return keyframes_; }
  std::map<uint64_t, Landmark>& landmarks() { return landmarks_; }
  const std::map<uint64_t, Landmark>& landmarks() const { return landmarks_; }
  const Keyframe& keyframe(uint32_t id) const { return keyframes_[id - keyframes_.front().id]; }
  bool slid() const { return slid_; }

 private:
  KeyframeParameters p_;
  std::deque<Keyframe> keyframes_;          // ids are consecutive
  std::map<uint64_t, Landmark> landmarks_;  // ordered, so that sums are repeatable
  bool slid_ = false;
};

}  // namespace odograph::vo
