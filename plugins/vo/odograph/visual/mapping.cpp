// SPDX-License-Identifier: Apache-2.0
//
// The map of keyframes: its growth, and the outliers that an adjustment removes.
#include <algorithm>
#include <cmath>

#include "plugins/vo/odograph/visual/bundle.hpp"
#include "plugins/shared/median.hpp"
#include "plugins/vo/odograph/visual/odometry.hpp"

namespace odograph::vo {
namespace {

Eigen::Vector3d ray(const Eigen::Vector2d& seen) { return Eigen::Vector3d(seen.x(), seen.y(), 1).normalized(); }

}  // namespace

/// True if there is enough parallax to triangulate, or few points of the last keyframe are left.
bool Odometry::wants_keyframe(const MapTracking& map) const {
  const auto few = [&](size_t left, size_t of) {
    return static_cast<double>(left) < p_.keyframe.few_left * static_cast<double>(of);
  };
  if (few(seen_.corners.size(), map.corners_before)) return false;  // wait for the next frame
  const Keyframe& last = window_.keyframes().back();
  const Eigen::Matrix3d R_k_c = last.T_w_c.linear().transpose() * track_.T_w_c.linear();
  std::vector<double> parallax;
  size_t triangulated = 0;
  const auto& landmarks = window_.landmarks();
  for (const SeenCorner& corner : seen_.corners) {
    const auto found = landmarks.find(corner.track);
    if (found == landmarks.end() || found->second.seen.empty()) continue;
    triangulated += found->second.triangulated;
    const Observation& o = found->second.seen.back();
    if (o.keyframe == last.id) parallax.push_back((R_k_c * ray(corner.at) - ray(o.seen)).norm());
  }
  return median(parallax) > p_.keyframe.parallax_rad || few(parallax.size(), map.corners_at_keyframe) ||
         few(triangulated, map.triangulated_at_keyframe);
}

/// Makes the latest frame a keyframe: observes its corners, adjusts the window and detects new corners.
void Odometry::make_keyframe(const Frame& frame, MapTracking& map) {
  // While the camera stands, new keyframes would push those with a baseline out of the window, and the scale would be
  // lost.
  const auto& keyframes = window_.keyframes();
  const size_t n = keyframes.size();
  if (n > 2 && (keyframes[n - 1].T_w_c.translation() - keyframes[n - 2].T_w_c.translation()).norm() <
                   p_.keyframe.standing * window_.depth_median())
    window_.drop_newest();
  const int64_t before_ns = window_.keyframes().back().t_ns;
  window_.add({0, frame.t_ns, track_.T_w_c, gyroscope_.between(before_ns, frame.t_ns, bias_c_), bias_c_});
  std::vector<uint64_t> alive;
  for (const SeenCorner& corner : seen_.corners) {
    window_.observe(corner.track, corner.at);
    alive.push_back(corner.track);
  }
  std::sort(alive.begin(), alive.end());
  window_.triangulate();
  adjust(window_, bias_c_, sigma(), p_.adjustment);
  drop_outliers();
  window_.update_depth_variance(sigma());
  window_.slide();
  window_.remove_untracked(alive);
  track_.T_w_c = window_.keyframes().back().T_w_c;
  track_.T_k_c.setIdentity();
  tracker_.refill(frame.mask);
  const size_t before = seen_.corners.size();
  seen_ = undistort(frame);
  for (size_t i = before; i < seen_.corners.size(); ++i) window_.observe(seen_.corners[i].track, seen_.corners[i].at);
  map.keyframe = RelocalisationKeyframe{tracker_.snapshot(), seen_};
  map.corners_at_keyframe = seen_.corners.size();
  map.triangulated_at_keyframe = 0;
  for (const SeenCorner& corner : seen_.corners)
    map.triangulated_at_keyframe += window_.landmarks()[corner.track].triangulated;
}

/// Removes observations with large residuals after an adjustment: moving objects and tracking errors.
void Odometry::drop_outliers() {
  const double bound = p_.keyframe.outlier_sigmas * sigma();
  std::vector<uint64_t> gone;
  for (auto& [track, landmark] : window_.landmarks()) {
    if (!landmark.triangulated) continue;
    const Eigen::Vector4d X = window_.point(landmark);
    int bad = 0;
    for (const Observation& o : landmark.seen) {
      const Eigen::Isometry3d& T = window_.keyframe(o.keyframe).T_w_c;
      const Eigen::Vector3d y = T.linear().transpose() * (X.head<3>() - X.w() * T.translation());
      bad += y.z() <= 0 || (y.head<2>() / y.z() - o.seen).norm() > bound;
    }
    if (bad > 1 || (bad == 1 && landmark.seen.size() < 4)) gone.push_back(track);
  }
  for (const uint64_t track : gone) window_.remove_landmark(track);
}

}  // namespace odograph::vo
