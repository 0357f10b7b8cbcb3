// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/facades.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace odograph::skyline {
namespace {

constexpr double kPi = std::numbers::pi;

int64_t cell_of(double north, double east, double size) {
  return static_cast<int64_t>(std::floor(north / size)) * (int64_t{1} << 32) +
         static_cast<int64_t>(std::floor(east / size));
}

}  // namespace

Facades::Facades(const std::vector<Edge>& edges, const FacadeParameters& parameters) : p_(parameters) {
  std::set<std::array<int64_t, 4>> known;  // in plan, dm: eaves and feet coincide
  const auto dm = [](const Eigen::Vector3d& p) {
    return std::pair(std::llround(10 * p.x()), std::llround(10 * p.y()));
  };
  for (const Edge& e : edges) {
    if (e.object < 0 && e.also < 0) continue;
    const Eigen::Vector3d along = e.to - e.from;
    const double length = along.head<2>().norm();
    if (length < p_.min_wall_m || length > p_.max_wall_m || std::abs(along.z()) > p_.max_slope * length) continue;
    const auto [a, b] = std::minmax({dm(e.from), dm(e.to)});
    if (!known.insert({a.first, a.second, b.first, b.second}).second) continue;
    const Eigen::Vector3d low = e.from.cwiseMin(e.to) / p_.reach_m, high = e.from.cwiseMax(e.to) / p_.reach_m;
    for (double north = std::floor(low.x()); north <= high.x(); ++north)
      for (double east = std::floor(low.y()); east <= high.y(); ++east)
        walls_[cell_of(north, east, 1)].push_back({e.from.head<2>().cast<float>(), e.to.head<2>().cast<float>()});
  }
}

void Facades::set(const std::vector<SeenLine>& lines, const Eigen::Quaterniond& q_n_c) {
  lines_.clear();
  double all = 0;
  for (const SeenLine& line : lines) {
    const Eigen::Vector3d n = q_n_c * line.normal_c;
    const double level = std::hypot(n.x(), n.y());  // sine of the angle between the line's plane and the horizon
    if (std::abs(n.z()) < std::sin(p_.vertical_rad)) continue;
    const double sigma = std::hypot(p_.line_rad / std::max(level, 1e-3), p_.wall_rad);
    if (sigma > p_.max_sigma_rad) continue;
    const double direction = std::atan2(n.x(), -n.y());
    const int parts = 1 + static_cast<int>(line.length_rad / p_.part_rad);
    const double length = line.length_rad / parts;
    for (int k = 0; k < parts; ++k) {
      const double part = (k + 0.5) / parts;
      const Eigen::Vector3d ray = q_n_c * ((1 - part) * line.from_c + part * line.to_c);
      if (-ray.z() < std::sin(p_.min_elevation_rad) * ray.norm()) continue;
      all += length;
      const double bearing = std::atan2(ray.y(), ray.x());
      const auto same = std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) {
        return std::abs(std::remainder(static_cast<double>(l.bearing) - bearing, 2 * kPi)) < p_.alike_rad &&
               std::abs(std::remainder(static_cast<double>(l.direction) - direction, kPi)) < p_.alike_rad;
      });
      if (same != lines_.end())
        same->weight += static_cast<float>(length);
      else
        lines_.push_back({static_cast<float>(bearing), static_cast<float>(direction), static_cast<float>(1 / sigma),
                          static_cast<float>(length)});
    }
  }
  for (Line& l : lines_) l.weight *= static_cast<float>(std::min(p_.weight, static_cast<double>(lines_.size())) / all);
}

/// The direction of the nearest wall in each bearing: a facade, since roofs' ridges and hips are behind it.
Facades::Directions Facades::look(const Eigen::Vector2f& from) const {
  constexpr double kStep = 2 * kPi / kBearings;
  Directions directions;
  directions.fill(std::numeric_limits<float>::quiet_NaN());
  std::array<double, kBearings> nearest;
  nearest.fill(p_.reach_m);
  for (int a = -1; a <= 1; ++a)
    for (int b = -1; b <= 1; ++b) {
      const auto walls = walls_.find(cell_of(static_cast<double>(from.x()) + a * p_.reach_m,
                                             static_cast<double>(from.y()) + b * p_.reach_m, p_.reach_m));
      if (walls == walls_.end()) continue;
      for (const Wall& wall : walls->second) {
        const Eigen::Vector2d u = (wall.from - from).cast<double>(), v = (wall.to - from).cast<double>(), d = v - u;
        const double cross = u.x() * v.y() - u.y() * v.x();
        if (std::abs(cross) < 1e-6) continue;
        const double start = std::atan2(u.y(), u.x()), end = std::atan2(v.y(), v.x());
        const double span = std::remainder(end - start, 2 * kPi), low = span > 0 ? start : end;
        const auto first = static_cast<int>(std::ceil(low / kStep)),
                   last = static_cast<int>(std::floor((low + std::abs(span)) / kStep));
        const auto direction = static_cast<float>(std::atan2(d.y(), d.x()));
        for (int k = first; k <= last; ++k) {
          // The ray (cos, sin) meets the wall at cross / (ray x d).
          const double c = std::cos(k * kStep), s = std::sin(k * kStep);
          const double distance = cross / (c * d.y() - s * d.x());
          const auto bearing = static_cast<size_t>((k % kBearings + kBearings) % kBearings);
          if (distance > 0 && distance < nearest[bearing]) nearest[bearing] = distance, directions[bearing] = direction;
        }
      }
    }
  return directions;
}

const Facades::Directions& Facades::around(const Eigen::Vector2d& north_east) {
  if (seen_.size() > p_.max_cells) seen_.clear();
  const auto [at, is_new] = seen_.try_emplace(cell_of(north_east.x(), north_east.y(), p_.cell_m));
  if (is_new) {
    const auto middle = [&](double m) { return static_cast<float>((std::floor(m / p_.cell_m) + 0.5) * p_.cell_m); };
    at->second = look({middle(north_east.x()), middle(north_east.y())});
  }
  return at->second;
}

double Facades::cost(const Eigen::Vector2d& north_east, double yaw) {
  if (lines_.empty()) return 0;
  const Directions& walls = around(north_east);
  double cost = 0;
  for (const Line& l : lines_) {
    const double bearing = (static_cast<double>(l.bearing) + yaw) * kBearings / (2 * kPi);
    const auto k = static_cast<size_t>(((std::lround(bearing) % kBearings) + kBearings) % kBearings);
    if (std::isnan(walls[k])) continue;
    const double off = std::remainder(static_cast<double>(l.direction) + yaw - static_cast<double>(walls[k]), kPi);
    const double inverse = static_cast<double>(l.inverse_sigma), x = off * inverse;
    const double density = std::sqrt(0.5 / kPi) * inverse * std::exp(-0.5 * x * x);
    cost -= static_cast<double>(l.weight) * std::log(1 - p_.on_wall + p_.on_wall * kPi * density);
  }
  return -std::log((1 - p_.contradicting) * std::exp(-cost) + p_.contradicting);
}

}  // namespace odograph::skyline
