// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sdk/tools/simulation/route.hpp"

namespace odograph {

/// A straight part of the route between two corners.
struct Leg {
  Eigen::Vector3d from, to;  ///< north, east, up
  Eigen::Vector3d along;     ///< unit, horizontal
  Eigen::Vector3d aside;     ///< unit, to the right
  double length;

  /// Point on the ground, in n, at d metres along and `right` metres beside the leg.
  Eigen::Vector3d at(double d, double right) const {
    Eigen::Vector3d p = from + d * along + right * aside;
    p.z() = -(from.z() + (to.z() - from.z()) * std::clamp(d / length, 0.0, 1.0));
    return p;
  }
  double heading() const { return std::atan2(along.y(), along.x()); }
  double distance_to(const Eigen::Vector3d& p_n) const {
    const Eigen::Vector3d d(p_n.x() - from.x(), p_n.y() - from.y(), 0);
    return (d - std::clamp(d.dot(along), 0.0, length) * along).norm();
  }
};

inline std::vector<Leg> legs_of(const Route& route) {
  std::vector<Leg> legs;
  const auto& points = route.points();
  for (size_t i = 1; i < points.size(); ++i) {
    Eigen::Vector3d along = points[i] - points[i - 1];
    along.z() = 0;
    const double length = along.norm();
    along /= length;
    legs.push_back({points[i - 1], points[i], along, {-along.y(), along.x(), 0}, length});
  }
  return legs;
}

/// Whether every leg is at least `clearance` away from the point.
inline bool is_free(const std::vector<Leg>& legs, const Eigen::Vector3d& p_n, double clearance) {
  return std::all_of(legs.begin(), legs.end(), [&](const Leg& leg) { return leg.distance_to(p_n) >= clearance; });
}

}  // namespace odograph
