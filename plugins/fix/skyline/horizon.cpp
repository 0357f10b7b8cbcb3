// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/horizon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odograph::skyline {
namespace {

constexpr int kN = Horizon::kDirections;
constexpr double kStep_rad = 2 * std::numbers::pi / kN;
constexpr int kLattice = 2;  // places to each side from which edges are looked for

struct Directions {
  std::array<float, kN> north, east;
  Directions() {
    for (int j = 0; j < kN; ++j) {
      const double azimuth = (j + 0.5) * kStep_rad;
      north[static_cast<size_t>(j)] = static_cast<float>(std::cos(azimuth));
      east[static_cast<size_t>(j)] = static_cast<float>(std::sin(azimuth));
    }
  }
};

/// The azimuth in steps, good to a third of one: enough to know which directions an edge may lie in.
float steps_of(float north, float east) {
  const float a = std::abs(north), b = std::abs(east), low = std::min(a, b), high = std::max(a, b);
  const float q = high > 0 ? low / high : 0;
  float angle = q * (0.9724f - 0.1919f * q * q);
  if (b > a) angle = 1.5707963f - angle;
  if (north < 0) angle = 3.1415927f - angle;
  return (east < 0 ? -angle : angle) * static_cast<float>(1 / kStep_rad);
}

}  // namespace

double Horizon::elevation_at(double azimuth_rad) const {
  constexpr double kSame_rad = 0.035;  // two degrees between neighbours: a wall's edge, not a roof's slope
  double at = azimuth_rad / kStep_rad - 0.5;
  at -= kN * std::floor(at / kN);
  const auto j = static_cast<size_t>(at) % kN, k = (j + 1) % kN;
  const double part = at - std::floor(at);
  const auto a = static_cast<double>(elevation[j]), b = static_cast<double>(elevation[k]);
  if (std::abs(a - b) > kSame_rad) return part < 0.5 ? a : b;
  return a + part * (b - a);
}

void City::look_around(const Eigen::Vector3d& p_n, double radius_m, double least_tan, double lower_m) {
  near_.clear();
  around_ = p_n;
  for (const Edge& e : edges_) {
    const double up = p_n.z() + lower_m - std::min(e.from.z(), e.to.z());
    if (up <= 0) continue;
    const Eigen::Vector2d a = (e.from - p_n).head<2>(), d = (e.to - e.from).head<2>();
    if (d.squaredNorm() < 1e-8) continue;  // a vertical edge: the roof's own edges end there
    const double t = std::clamp(-a.dot(d) / d.squaredNorm(), 0.0, 1.0);
    const double distance = (a + t * d).norm();
    if (up <= least_tan * (distance - radius_m)) continue;
    const Eigen::Vector3f from = (e.from - p_n).cast<float>(), along = (e.to - e.from).cast<float>();
    near_.push_back({from.x(), from.y(), from.z(), along.x(), along.y(), along.z(),
                     static_cast<float>(up / std::max(distance, 0.1))});
  }
  // What stands highest first: most of the others are then hidden at once.
  std::sort(near_.begin(), near_.end(), [](const Near& a, const Near& b) { return a.bound > b.bound; });
  std::vector<char> seen(near_.size(), 0);
  Horizon there;
  Winners winners;
  for (int a = -kLattice; a <= kLattice; ++a)
    for (int b = -kLattice; b <= kLattice; ++b) {
      envelope(near_, p_n + Eigen::Vector3d(a, b, 0) * (radius_m / kLattice), there, &winners);
      for (const int winner : winners)
        if (winner >= 0) seen[static_cast<size_t>(winner)] = 1;
    }
  visible_.clear();
  for (size_t i = 0; i < near_.size(); ++i)
    if (seen[i]) visible_.push_back(near_[i]);
}

void City::envelope(const std::vector<Near>& edges, const Eigen::Vector3d& p_n, Horizon& out, Winners* winners) const {
  static const Directions directions;
  std::array<float, kN> highest{};  // tangents
  out.height_m.fill(0), out.distance_m.fill(0);
  const Eigen::Vector3f shift = (p_n - around_).cast<float>();
  if (winners) winners->fill(-1);
  for (size_t i = 0; i < edges.size(); ++i) {
    const Near& e = edges[i];
    const float x0 = e.x - shift.x(), y0 = e.y - shift.y(), h0 = shift.z() - e.z;
    const float x1 = x0 + e.dx, y1 = y0 + e.dy, h1 = h0 - e.dz;
    if (h0 <= 0 && h1 <= 0) continue;
    const float cross = x0 * y1 - y0 * x1;  // > 0: the azimuth grows from `from` to `to`
    const float begin = cross >= 0 ? steps_of(x0, y0) : steps_of(x1, y1);
    float end = cross >= 0 ? steps_of(x1, y1) : steps_of(x0, y0);
    if (end < begin - 1) end += kN;
    if (end - begin > kN / 2 + 1) continue;  // seen from its own line
    const int first = static_cast<int>(std::floor(begin - 1.1f)), last = static_cast<int>(std::ceil(end + 0.1f));
    for (int j = first; j <= last; ++j) {
      const auto k = static_cast<size_t>(j < 0 ? j + kN : j >= kN ? j - kN : j);
      // Where the ray (c, s) meets the edge: from + t (to - from), at the distance r.
      const float c = directions.north[k], s = directions.east[k];
      const float det = c * e.dy - s * e.dx;
      if (std::abs(det) < 1e-7f) continue;
      const float t = (s * x0 - c * y0) / det;
      if (t < 0 || t > 1) continue;
      const float r = c * (x0 + t * e.dx) + s * (y0 + t * e.dy);
      if (r <= 1e-3f) continue;
      const float h = h0 - t * e.dz;
      if (h <= highest[k] * r) continue;
      highest[k] = h / r, out.height_m[k] = h, out.distance_m[k] = r;
      if (winners) (*winners)[k] = static_cast<int>(i);
    }
  }
  for (size_t k = 0; k < highest.size(); ++k) out.elevation[k] = std::atan(highest[k]);
}

}  // namespace odograph::skyline
