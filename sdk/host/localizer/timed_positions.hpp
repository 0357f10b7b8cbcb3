// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "sdk/math/ring.hpp"

namespace odograph {

/// The newest positions of a moving object, with interpolation. No allocation.
class TimedPositions {
 public:
  void clear() { points_.clear(); }
  /// In time order.
  void add(int64_t t_ns, const Eigen::Vector3d& p) { points_.push({t_ns, p}); }

  /// Position at a time, linearly interpolated; the newest position for less than `reach_ns` after it; otherwise
  /// nothing.
  std::optional<Eigen::Vector3d> at(int64_t t_ns, int64_t reach_ns = 0) const {
    for (size_t i = 0; i < points_.size(); ++i) {
      const Point& point = points_.back(i);
      if (point.t_ns > t_ns) continue;
      if (point.t_ns == t_ns) return point.p;
      if (i == 0) return t_ns - point.t_ns < reach_ns ? std::optional(point.p) : std::nullopt;
      const Point& next = points_.back(i - 1);
      const double w = static_cast<double>(t_ns - point.t_ns) / static_cast<double>(next.t_ns - point.t_ns);
      return point.p + w * (next.p - point.p);
    }
    return std::nullopt;
  }

 private:
  struct Point {
    int64_t t_ns;
    Eigen::Vector3d p;
  };
  Ring<Point, 256> points_;
};

}  // namespace odograph
