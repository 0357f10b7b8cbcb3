// SPDX-License-Identifier: Apache-2.0
#include "plugins/surface/planes/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace odograph::planes {

using Eigen::Vector2d;

namespace {

constexpr size_t kMostVertices = 32;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

std::vector<Vector2d> hull_of(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(),
            [](const Vector2d& a, const Vector2d& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  std::vector<Vector2d> hull;
  for (const bool back : {false, true}) {
    const size_t start = hull.size();
    for (const Vector2d& p : points) {
      while (hull.size() > start + 1 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 1e-12)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    if (!back) std::reverse(points.begin(), points.end());
  }
  while (hull.size() > kMostVertices) {
    size_t worst = 0;
    double min_area = 1e300;
    for (size_t i = 0; i < hull.size(); ++i) {
      const Vector2d &a = hull[(i + hull.size() - 1) % hull.size()], &b = hull[i], &c = hull[(i + 1) % hull.size()];
      if (const double area = cross(b - a, c - b); area < min_area) min_area = area, worst = i;
    }
    hull.erase(hull.begin() + static_cast<ptrdiff_t>(worst));
  }
  return hull;
}

double outside(const std::vector<Vector2d>& outline, const Vector2d& p) {
  double farthest = 0;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Vector2d side = outline[(i + 1) % outline.size()] - outline[i];
    if (const double length = side.norm(); length > 0)
      farthest = std::max(farthest, -cross(side, p - outline[i]) / length);
  }
  return farthest;
}

double width_of(const std::vector<Vector2d>& outline) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < outline.size(); ++i) {
    const Vector2d side = (outline[(i + 1) % outline.size()] - outline[i]).normalized();
    double widest = 0;
    for (const Vector2d& p : outline) widest = std::max(widest, cross(side, p - outline[i]));
    narrowest = std::min(narrowest, widest);
  }
  return narrowest;
}

double area_of(const std::vector<Vector2d>& outline) {
  double twice = 0;
  for (size_t i = 0; i < outline.size(); ++i) twice += cross(outline[i], outline[(i + 1) % outline.size()]);
  return 0.5 * twice;
}

}  // namespace odograph::planes
