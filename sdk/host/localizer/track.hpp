// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/math/ring.hpp"

namespace odograph {

/// A pose of the body in the odometry frame o, which is gravity-aligned and in which the track never jumps, with the
/// variances accumulated since the track began.
struct TrackPoint {
  int64_t t_ns = INT64_MIN;
  Eigen::Quaterniond q_o_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_o_b = Eigen::Vector3d::Zero();  ///< m
  double path_m = 0;                                ///< travelled until then
  Eigen::Vector3d drift_m2 = Eigen::Vector3d::Zero();
  double heading_drift_rad2 = 0;
};

/// The newest poses in o, for measurements and anchors in the past. No allocation. Not thread-safe.
class Track {
 public:
  void clear() { points_.clear(); }
  bool empty() const { return points_.empty(); }
  const TrackPoint& newest() const { return points_.back(0); }
  /// In time order; a pose at the newest time replaces it.
  void push(const TrackPoint& point) {
    if (!empty() && point.t_ns <= newest().t_ns)
      points_.back(0) = point;
    else
      points_.push(point);
  }

  /// The pose at a time: interpolated; the newest after its time; nothing before the oldest stored.
  std::optional<TrackPoint> at(int64_t t_ns) const {
    if (empty()) return std::nullopt;
    if (t_ns >= newest().t_ns) return newest();
    size_t newer = 0, older = points_.size() - 1;
    if (t_ns < points_.back(older).t_ns) return std::nullopt;
    while (older - newer > 1) {
      const size_t middle = (newer + older) / 2;
      (points_.back(middle).t_ns > t_ns ? newer : older) = middle;
    }
    const TrackPoint &a = points_.back(older), &b = points_.back(newer);
    const double w = static_cast<double>(t_ns - a.t_ns) / static_cast<double>(b.t_ns - a.t_ns);
    TrackPoint out = w < 0.5 ? a : b;
    out.t_ns = t_ns;
    out.q_o_b = a.q_o_b.slerp(w, b.q_o_b);
    out.p_o_b = a.p_o_b + w * (b.p_o_b - a.p_o_b);
    out.path_m = a.path_m + w * (b.path_m - a.path_m);
    out.drift_m2 = a.drift_m2 + w * (b.drift_m2 - a.drift_m2);
    out.heading_drift_rad2 = a.heading_drift_rad2 + w * (b.heading_drift_rad2 - a.heading_drift_rad2);
    return out;
  }

 private:
  Ring<TrackPoint, 1024> points_;
};

}  // namespace odograph
