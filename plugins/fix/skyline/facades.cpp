// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/facades.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace odograph::skyline {
namespace {

constexpr double kPi = std::numbers::pi;

int64_t key_of(int64_t north, int64_t east) { return north * (int64_t{1} << 32) + east; }
int64_t whole(double x) { return static_cast<int64_t>(std::floor(x)); }

}  // namespace

Facades::Facades(const std::vector<Edge>& edges, const FacadeParameters& parameters) : p_(parameters) {
  std::map<std::array<int64_t, 4>, Wall> walls;  // by plan, dm: eaves and feet coincide
  const auto dm = [](const Eigen::Vector3d& p) {
    return std::pair(std::llround(10 * p.x()), std::llround(10 * p.y()));
  };
  for (const Edge& e : edges) {
    if (e.object < 0 && e.also < 0) continue;
    const Eigen::Vector3d along = e.to - e.from;
    const double length = along.head<2>().norm();
    if (length < p_.min_wall_m || length > p_.max_wall_m || std::abs(along.z()) > p_.max_slope * length) continue;
    const auto [a, b] = std::minmax({dm(e.from), dm(e.to)});
    const double top = std::min(e.from.z(), e.to.z());
    const auto [at, is_new] =
        walls.try_emplace({a.first, a.second, b.first, b.second}, Wall{e.from.head<2>(), e.to.head<2>(), top});
    at->second.top = std::min(at->second.top, top);
  }
  for (const auto& [plan, wall] : walls) {
    const Eigen::Vector2d from = wall.from / p_.reach_m, to = wall.to / p_.reach_m;
    for (int64_t north = whole(std::min(from.x(), to.x())); north <= whole(std::max(from.x(), to.x())); ++north)
      for (int64_t east = whole(std::min(from.y(), to.y())); east <= whole(std::max(from.y(), to.y())); ++east)
        walls_[key_of(north, east)].push_back(wall);
  }
}

void Facades::set(const std::vector<SeenLine>& lines, const Eigen::Quaterniond& q_n_c, double tilt_sigma_rad) {
  lines_.clear();
  double all = 0, independent = 0;
  for (const SeenLine& line : lines) {
    const Eigen::Vector3d n = q_n_c * line.normal_c;
    const double level = std::hypot(n.x(), n.y());  // sine of the angle between the line's plane and the horizon
    if (std::abs(n.z()) < std::sin(p_.vertical_rad)) continue;
    const double sigma =
        std::hypot(std::hypot(p_.line_rad, tilt_sigma_rad * n.z()) / std::max(level, 1e-3), p_.wall_rad);
    if (sigma > p_.max_sigma_rad) continue;
    const double direction = std::atan2(n.x(), -n.y());
    const int parts = 1 + static_cast<int>(line.length_rad / p_.part_rad);
    const double length = line.length_rad / parts;
    bool is_new = false;
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
        is_new = true, lines_.push_back({static_cast<float>(bearing), static_cast<float>(direction),
                                         static_cast<float>(1 / sigma), static_cast<float>(length)});
    }
    independent += is_new;
  }
  for (Line& l : lines_) l.weight *= static_cast<float>(std::min(p_.max_lines, independent) / all);
}

/// The direction of the nearest wall in each bearing: a facade, since roofs' ridges and hips are behind it.
Facades::Directions Facades::nearest_walls(const Eigen::Vector3d& p_n) const {
  constexpr double kStep = 2 * kPi / kBearings;
  Directions directions;
  directions.fill(std::numeric_limits<float>::quiet_NaN());
  std::array<double, kBearings> nearest;
  nearest.fill(p_.reach_m);
  const Eigen::Vector2d here = p_n.head<2>();
  for (int a = -1; a <= 1; ++a)
    for (int b = -1; b <= 1; ++b) {
      const auto walls = walls_.find(key_of(whole(here.x() / p_.reach_m) + a, whole(here.y() / p_.reach_m) + b));
      if (walls == walls_.end()) continue;
      for (const Wall& wall : walls->second) {
        if (p_n.z() - wall.top < p_.min_above_m) continue;
        const Eigen::Vector2d u = wall.from - here, v = wall.to - here, d = v - u;
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

/// From a place of the lattice, with the height of the camera at the first one nearby.
const Facades::Directions& Facades::directions_from(int64_t north, int64_t east, double down) {
  if (seen_.size() > p_.max_places) seen_.clear();
  const auto [at, is_new] = seen_.try_emplace(key_of(north, east));
  if (is_new)
    at->second = nearest_walls({static_cast<double>(north) * p_.step_m, static_cast<double>(east) * p_.step_m, down});
  return at->second;
}

/// A bearing without a wall is no evidence: a house that the model lacks opens it as often.
double Facades::cost_of_lines(const Directions& walls, double yaw) const {
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
  return cost;
}

double Facades::cost(const Eigen::Vector3d& p_n, double yaw) {
  if (lines_.empty()) return 0;
  const Eigen::Vector2d at = p_n.head<2>() / p_.step_m;
  const int64_t north = whole(at.x()), east = whole(at.y());
  const double u = at.x() - static_cast<double>(north), v = at.y() - static_cast<double>(east);
  double cost = 0;
  for (const int a : {0, 1})
    for (const int b : {0, 1})
      cost += (a ? u : 1 - u) * (b ? v : 1 - v) * cost_of_lines(directions_from(north + a, east + b, p_n.z()), yaw);
  return -std::log((1 - p_.contradicting) * std::exp(-cost) + p_.contradicting);
}

}  // namespace odograph::skyline
