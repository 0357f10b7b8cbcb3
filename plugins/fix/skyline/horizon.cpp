// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/horizon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odograph::skyline {
namespace {

constexpr int kN = Horizon::kDirections;
constexpr double kStep_rad = 2 * std::numbers::pi / kN;

struct Directions {
  std::array<double, kN> north, east;
  Directions() {
    for (int j = 0; j < kN; ++j) {
      const double azimuth = (j + 0.5) * kStep_rad;
      north[static_cast<size_t>(j)] = std::cos(azimuth), east[static_cast<size_t>(j)] = std::sin(azimuth);
    }
  }
};

}  // namespace

void City::look_around(const Eigen::Vector3d& p_n, double radius_m, double least_tan) {
  near_.clear();
  for (const Edge& e : edges_) {
    const double up = p_n.z() - std::min(e.from.z(), e.to.z());
    if (up <= 0) continue;
    const Eigen::Vector2d a = e.from.head<2>() - p_n.head<2>(), d = (e.to - e.from).head<2>();
    const double t = d.squaredNorm() > 0 ? std::clamp(-a.dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
    if (up > least_tan * ((a + t * d).norm() - radius_m)) near_.push_back(e);
  }
}

void City::horizon(const Eigen::Vector3d& p_n, Horizon& out) const {
  static const Directions directions;
  std::array<float, kN> highest{};  // tangents
  out.height_m.fill(0);
  for (const Edge& e : near_) {
    const double x0 = e.from.x() - p_n.x(), y0 = e.from.y() - p_n.y(), h0 = p_n.z() - e.from.z();
    const double x1 = e.to.x() - p_n.x(), y1 = e.to.y() - p_n.y(), h1 = p_n.z() - e.to.z();
    if (h0 <= 0 && h1 <= 0) continue;
    const double cross = x0 * y1 - y0 * x1;  // > 0: the azimuth grows from `from` to `to`
    const double begin = std::atan2(cross >= 0 ? y0 : y1, cross >= 0 ? x0 : x1);
    const double span = std::atan2(std::abs(cross), x0 * x1 + y0 * y1);
    const int first = static_cast<int>(std::ceil(begin / kStep_rad - 0.5));
    const int last = static_cast<int>(std::floor((begin + span) / kStep_rad - 0.5));
    for (int j = first; j <= last; ++j) {  // none for a vertical edge: the roof's own edges end there
      const auto k = static_cast<size_t>((j % kN + kN) % kN);
      // Where the ray (c, s) meets the edge: from + t (to - from), at the distance r.
      const double c = directions.north[k], s = directions.east[k];
      const double dx = x1 - x0, dy = y1 - y0, det = c * dy - s * dx;
      if (std::abs(det) < 1e-9) continue;
      const double t = (s * x0 - c * y0) / det, r = c * (x0 + t * dx) + s * (y0 + t * dy);
      if (r <= 1e-3) continue;
      const double h = h0 + t * (h1 - h0);
      const auto elevation_tan = static_cast<float>(h / r);
      if (elevation_tan <= highest[k]) continue;
      highest[k] = elevation_tan, out.height_m[k] = static_cast<float>(h);
    }
  }
  for (size_t k = 0; k < highest.size(); ++k) out.elevation[k] = std::atan(highest[k]);
}

}  // namespace odograph::skyline
