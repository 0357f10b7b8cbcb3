// SPDX-License-Identifier: Apache-2.0
//
// The landmarks of a front-end's frames as odo_points.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <odograph/plugin.hpp>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/point_tracks.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

/// At most ODO_MOST_POINTS of the points, the most certain first, spread over the picture: the best of each cell, then
/// the second best of each, and so on.
inline void choose(std::vector<TrackedPoint>& points, cv::Size size) {
  constexpr int kCells = 16;  // along each side
  const auto relative = [](const TrackedPoint& p) { return p.covariance.trace() / p.p_c.squaredNorm(); };
  std::stable_sort(points.begin(), points.end(), [&](const TrackedPoint& a, const TrackedPoint& b) {
    return std::pair(a.lost, relative(a)) < std::pair(b.lost, relative(b));
  });
  if (points.size() <= ODO_MOST_POINTS) return;
  std::map<std::pair<int, int>, int> in_cell;
  std::vector<std::pair<int, size_t>> rank;
  for (size_t i = 0; i < points.size(); ++i) {
    const auto cell = [](double at, int length) { return static_cast<int>(std::floor(at * kCells / length)); };
    rank.emplace_back(in_cell[{cell(points[i].pixel.x(), size.width), cell(points[i].pixel.y(), size.height)}]++, i);
  }
  std::sort(rank.begin(), rank.end());
  std::vector<TrackedPoint> chosen;
  for (const auto& [of_cell, i] : rank) chosen.push_back(points[i]);
  points.swap(chosen);
}

inline odo_point element_of(const TrackedPoint& point) {
  odo_point out{};
  out.id = point.id;
  Eigen::Vector3f::Map(out.p_c) = point.p_c.cast<float>();
  const Eigen::Matrix3f P = point.covariance.cast<float>();
  const float upper[] = {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)};
  std::copy(std::begin(upper), std::end(upper), out.covariance);
  Eigen::Vector2f::Map(out.pixel) = point.pixel.cast<float>();
  out.age = point.age;
  if (point.used) out.flags |= ODO_POINT_USED;
  if (point.lost) out.flags |= ODO_POINT_LOST;
  if (point.uncertain) out.flags |= ODO_POINT_UNCERTAIN;
  return out;
}

/// Emits the landmarks of each frame before its motion.
class PointsEvent {
 public:
  /// Before `motion` is emitted: its frame's corners, in the picture of this lens and size, with their noise.
  void emit(const odo_vo_motion& motion, const std::vector<TrackedCorner>& corners, double sigma_rad,
            const CameraModel& lens, cv::Size size, odo::Output& output) {
    constexpr uint32_t needed = ODO_VO_ROTATION | ODO_VO_TRANSLATION;
    if (motion.scale_group != group_ || (motion.header.flags & needed) != needed) tracks_.clear();
    group_ = motion.scale_group;
    if ((motion.header.flags & needed) != needed) return;
    tracks_.move(raw_quaternion(motion.q_c0_c1), Eigen::Vector3d(motion.p_c0_c1));
    if (corners.empty()) return;  // a frame that was not estimated
    points_ = tracks_.see(corners, sigma_rad);
    // Those that the camera has passed: no lens has a pixel for them.
    std::erase_if(points_, [](const TrackedPoint& p) { return p.lost && p.p_c.z() < kLowest * p.p_c.norm(); });
    if (points_.empty()) return;
    for (TrackedPoint& point : points_)
      if (point.lost) point.pixel = lens.project(point.p_c.head<2>() / point.p_c.z());
    choose(points_, size);
    writer_.begin(motion.header.t_ns, motion.camera, motion.scale_group, (motion.header.flags & ODO_VO_METRIC) != 0);
    for (const TrackedPoint& point : points_) writer_.add(element_of(point));
    output.emit(writer_);
  }

 private:
  static constexpr double kLowest = 0.1;  // cosine of the angle to the axis: beyond 84 degrees x/z grows without bound

  PointTracks tracks_;
  std::vector<TrackedPoint> points_;
  odo::PointsWriter writer_;
  uint32_t group_ = 0;
};

}  // namespace odograph
