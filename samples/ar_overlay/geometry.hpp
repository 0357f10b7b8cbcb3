// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <opencv2/core.hpp>

/// A point in metres: in n (north, east, down) or in the camera's axes (right, down, forward), by the name of the
/// variable.
using Point = cv::Point3d;

/// Rotates a vector by a quaternion w, x, y, z.
inline Point rotate(const double* q, const Point& v) {
  const Point u(q[1], q[2], q[3]);
  const Point t = 2.0 * u.cross(v);
  return v + q[0] * t + u.cross(t);
}

/// The inverse rotation.
inline Point rotate_back(const double* q, const Point& v) {
  const double inverse[4] = {q[0], -q[1], -q[2], -q[3]};
  return rotate(inverse, v);
}

inline double length(const Point& v) { return std::sqrt(v.dot(v)); }
