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

void make_hull(std::vector<Vector2d>& points) {
  const size_t n = points.size();
  if (n < 3) return;
  std::sort(points.begin(), points.end(),
            [](const Vector2d& a, const Vector2d& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  points.reserve(3 * n);  // the hull grows behind them
  for (const bool back : {false, true}) {
    const size_t start = points.size();
    for (size_t i = 0; i < n; ++i) {
      const Vector2d p = points[back ? n - 1 - i : i];
      while (points.size() > start + 1 && cross(points.back() - points[points.size() - 2], p - points.back()) <= 1e-12)
        points.pop_back();
      points.push_back(p);
    }
    points.pop_back();
  }
  points.erase(points.begin(), points.begin() + static_cast<ptrdiff_t>(n));
  while (points.size() > kMostVertices) {
    size_t worst = 0;
    double min_area = 1e300;
    for (size_t i = 0; i < points.size(); ++i) {
      const Vector2d &a = points[(i + points.size() - 1) % points.size()], &b = points[i],
                     &c = points[(i + 1) % points.size()];
      if (const double area = cross(b - a, c - b); area < min_area) min_area = area, worst = i;
    }
    points.erase(points.begin() + static_cast<ptrdiff_t>(worst));
  }
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
