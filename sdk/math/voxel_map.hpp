// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace odograph {

/// A landmark with its covariance, in metres, in a frame that moves with the track.
struct MapPoint {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  float scale_sigma = 1;  ///< relative, of the metre in which p is: an error that it shares with others of its time
  Eigen::Vector3f eye = Eigen::Vector3f::Zero();       ///< where the camera was
  int64_t t_ns = std::numeric_limits<int64_t>::min();  ///< of the newest frame that saw it; the least value: no point

  bool any() const { return t_ns != std::numeric_limits<int64_t>::min(); }
  double sigma_m() const { return std::sqrt(static_cast<double>(covariance.trace())); }
};

/// Standard deviation of what the metre has changed by, relative, since it was known to `then`: what is known now to
/// `now` contains what was known then, so the variance of the difference is that of then less that of now.
inline double metre_change_sigma(double then, double now) { return std::sqrt(std::max(0.0, then * then - now * now)); }

/// Whether what was measured with that scale is still worth keeping, else it is a ghost beside what is seen again.
inline bool scale_is_current(double then, double now) {
  constexpr double kMost = 0.04;  // 6 cm, a third of a step, for a floor 1.5 m below
  return metre_change_sigma(then, now) < kMost;
}

/// At most 8 * sets landmarks, one in each cube, in memory that is allocated once. Where eight cubes of one hash value
/// are taken, the point that was seen last of all gives way.
class VoxelMap {
 public:
  VoxelMap(size_t sets, double side_m) : side_m_(side_m), sets_(sets), points_(sets * kWays) {}

  /// Replaces the point of its cube, unless that one is clearly better.
  void add(const MapPoint& point) {
    constexpr float kWorse = 4;  // variances: a point seen again with half the accuracy is not better for being newer
    const Cube cube = cube_of(point.p);
    MapPoint* place = &points_[hash(cube) % sets_ * kWays];
    MapPoint* oldest = place;
    for (MapPoint* at = place; at != place + kWays; ++at) {
      if (at->any() && cube_of(at->p) == cube) {
        if (point.covariance.trace() < kWorse * at->covariance.trace())
          *at = point;
        else
          at->t_ns = point.t_ns, at->eye = point.eye;
        return;
      }
      if (at->t_ns < oldest->t_ns) oldest = at;
    }
    *oldest = point;
  }
  void clear() { points_.assign(points_.size(), {}); }

  template <class Visit>
  void visit(Visit&& each) const {
    for (const MapPoint& point : points_)
      if (point.any()) each(point);
  }

 private:
  static constexpr size_t kWays = 8;
  using Cube = Eigen::Matrix<int64_t, 3, 1>;
  Cube cube_of(const Eigen::Vector3d& p) const {
    return {static_cast<int64_t>(std::floor(p.x() / side_m_)), static_cast<int64_t>(std::floor(p.y() / side_m_)),
            static_cast<int64_t>(std::floor(p.z() / side_m_))};
  }
  /// Teschner et al. 2003, mixed.
  static size_t hash(const Cube& cube) {
    const auto u = [](int64_t x) { return static_cast<uint64_t>(x); };
    const uint64_t h = u(cube.x()) * 73856093u ^ u(cube.y()) * 19349663u ^ u(cube.z()) * 83492791u;
    return static_cast<size_t>((h * 0x9E3779B97F4A7C15u) >> 40);
  }

  double side_m_;
  size_t sets_;
  std::vector<MapPoint> points_;
};

}  // namespace odograph
