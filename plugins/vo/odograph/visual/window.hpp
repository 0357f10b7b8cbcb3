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
  std::optional<GyroRotation> rotation;  ///< from the keyframe before, with the bias of then
  Eigen::Vector3d rotation_bias_c;
};

struct Observation {
  uint32_t keyframe;
  Eigen::Vector2d seen;  ///< normalized
};

/// A point as its first keyframe in the window has it: a ray, and the inverse of the depth along z (Civera et al.
/// 2008).
struct Landmark {
  std::vector<Observation> seen;  ///< the first is the anchor
  double inverse_depth = 0, variance = 0;
  bool located = false;  ///< the depth means something
  int misses = 0;
};

/// The last keyframes and what they saw.
class Window {
 public:
  explicit Window(const KeyframeParameters& parameters) : p_(parameters) {}

  void clear();
  void add(Keyframe keyframe);
  /// The newest keyframe goes, with what it saw: the next one takes its place.
  void drop_newest();
  void observe(uint64_t track, const Eigen::Vector2d& seen);  ///< by the newest keyframe
  /// Depths of points that have come to have parallax; the others stay unlocated.
  void triangulate();
  /// Forgets the oldest keyframe where there are too many; points that it anchored hang on the next that saw them.
  void slide();
  void forget(uint64_t track) { landmarks_.erase(track); }
  void forget_but(const std::vector<uint64_t>& alive);  ///< points seen by fewer than two and not followed any more

  Eigen::Vector4d point(const Landmark& landmark) const;  ///< in w, homogeneous
  Eigen::Vector3d anchor(const Landmark& landmark) const {
    return keyframe(landmark.seen.front().keyframe).T_w_c.translation();
  }
  /// What the observations leave uncertain of each inverse depth, the poses taken as known.
  void update_depth_variance(double sigma);
  double depth_median() const;
  size_t located() const;

  std::deque<Keyframe>& keyframes() { return keyframes_; }
  const std::deque<Keyframe>& keyframes() const { return keyframes_; }
  std::map<uint64_t, Landmark>& landmarks() { return landmarks_; }
  const std::map<uint64_t, Landmark>& landmarks() const { return landmarks_; }
  const Keyframe& keyframe(uint32_t id) const { return keyframes_[id - keyframes_.front().id]; }
  bool slid() const { return slid_; }
  size_t most() const { return p_.window; }

 private:
  KeyframeParameters p_;
  std::deque<Keyframe> keyframes_;          // ids without gaps
  std::map<uint64_t, Landmark> landmarks_;  // ordered: the same sums in the same order each time
  bool slid_ = false;
};

}  // namespace odograph::vo
