// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/window.hpp"

#include <algorithm>
#include <utility>

#include "plugins/shared/camera/two_view.hpp"
#include "plugins/shared/median.hpp"

namespace odograph::vo {
namespace {

Eigen::Vector3d homogeneous(const Eigen::Vector2d& seen) { return {seen.x(), seen.y(), 1.0}; }

}  // namespace

void Window::clear() {
  keyframes_.clear(), landmarks_.clear();
  slid_ = false;
}

void Window::add(Keyframe keyframe) {
  keyframe.id = keyframes_.empty() ? 0 : keyframes_.back().id + 1;
  keyframes_.push_back(std::move(keyframe));
}

void Window::drop_newest() {
  for (auto& [track, landmark] : landmarks_) {
    if (landmark.seen.empty() || landmark.seen.back().keyframe != keyframes_.back().id) continue;
    landmark.seen.pop_back();
    if (landmark.seen.empty()) landmark.triangulated = false;
  }
  keyframes_.pop_back();
}

void Window::observe(uint64_t track, const Eigen::Vector2d& seen) {
  landmarks_[track].seen.push_back({keyframes_.back().id, seen});
}

Eigen::Vector4d Window::point(const Landmark& landmark) const {
  const Eigen::Isometry3d& T = keyframe(landmark.seen.front().keyframe).T_w_c;
  Eigen::Vector4d X;
  X << T.linear() * homogeneous(landmark.seen.front().seen) + landmark.inverse_depth * T.translation(),
      landmark.inverse_depth;
  return X;
}

void Window::triangulate() {
  std::vector<Sighting> sightings;
  for (auto& [track, landmark] : landmarks_) {
    if (landmark.triangulated || landmark.seen.size() < 2) continue;
    sightings.clear();
    for (const Observation& o : landmark.seen)
      sightings.push_back({keyframe(o.keyframe).T_w_c, {o.seen.x(), o.seen.y()}});
    const auto X = odograph::triangulate(sightings, p_.triangulation_error, p_.point_parallax_rad);
    if (!X) continue;
    const double depth = (sightings.front().T_w_c.inverse() * *X).z();
    if (depth <= 0) continue;
    landmark.inverse_depth = 1 / depth;
    landmark.triangulated = true;
  }
}

void Window::update_depth_variance(double sigma) {
  for (auto& [track, landmark] : landmarks_) {
    if (!landmark.triangulated) continue;
    const Eigen::Vector4d X = point(landmark);
    double information = 0;
    for (size_t i = 1; i < landmark.seen.size(); ++i) {
      const Eigen::Isometry3d& T = keyframe(landmark.seen[i].keyframe).T_w_c;
      const Eigen::Vector3d y = T.linear().transpose() * (X.head<3>() - X.w() * T.translation());
      const Eigen::Vector3d d = T.linear().transpose() * (anchor(landmark) - T.translation());
      if (y.z() > 1e-6) information += ((d.head<2>() - d.z() / y.z() * y.head<2>()) / y.z()).squaredNorm();
    }
    // Without other observations the variance stays unchanged.
    if (information > 0) landmark.variance = sigma * sigma / information;
  }
}

void Window::slide() {
  while (keyframes_.size() > p_.window) {
    const Keyframe oldest = keyframes_.front();
    for (auto& [track, landmark] : landmarks_) {
      if (landmark.seen.empty() || landmark.seen.front().keyframe != oldest.id) continue;
      const Eigen::Vector4d X = point(landmark);
      landmark.seen.erase(landmark.seen.begin());
      if (landmark.seen.empty()) {
        landmark.triangulated = false;
        continue;
      }
      const Eigen::Isometry3d& T = keyframe(landmark.seen.front().keyframe).T_w_c;
      const double z = T.linear().col(2).dot(X.head<3>() - X.w() * T.translation());
      landmark.triangulated = landmark.triangulated && z > 1e-6;
      landmark.inverse_depth = landmark.triangulated ? X.w() / z : 0;
    }
    keyframes_.pop_front();
    slid_ = true;
  }
}

void Window::remove_untracked(const std::vector<uint64_t>& alive) {
  for (auto it = landmarks_.begin(); it != landmarks_.end();) {
    const bool followed = std::binary_search(alive.begin(), alive.end(), it->first);
    const bool useful = it->second.seen.size() >= 2;
    it = followed || useful ? std::next(it) : landmarks_.erase(it);
  }
}

double Window::depth_median() const {
  std::vector<double> depths;
  const Eigen::Isometry3d T_c_w = keyframes_.back().T_w_c.inverse();
  for (const auto& [track, landmark] : landmarks_) {
    if (!landmark.triangulated) continue;
    const Eigen::Vector4d X = point(landmark);
    if (X.w() > 1e-9) depths.push_back((T_c_w * (X.head<3>() / X.w())).z());
  }
  if (depths.empty()) return p_.farthest;
  return median(std::move(depths));
}

size_t Window::triangulated() const {
  return static_cast<size_t>(
      std::count_if(landmarks_.begin(), landmarks_.end(), [](const auto& entry) { return entry.second.triangulated; }));
}

}  // namespace odograph::vo
