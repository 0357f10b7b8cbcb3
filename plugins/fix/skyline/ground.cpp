// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/ground.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace odograph::skyline {

Ground::Ground(const std::vector<Edge>& edges, const Parameters& parameters) : p_(parameters) {
  int objects = 0;
  for (const Edge& e : edges) objects = std::max({objects, e.object + 1, e.also + 1});
  std::vector<double> lowest(static_cast<size_t>(objects), -1e300);  // down
  const auto each = [&](auto&& edge_of) {
    for (const Edge& e : edges)
      for (const int object : {e.object, e.also})
        if (object >= 0) edge_of(e, static_cast<size_t>(object));
  };
  each([&](const Edge& e, size_t object) { lowest[object] = std::max({lowest[object], e.from.z(), e.to.z()}); });
  buildings_.resize(lowest.size());
  each([&](const Edge& e, size_t object) {
    const double foot = lowest[object] - p_.foot_m;
    for (const Eigen::Vector3d& corner : {e.from, e.to})
      if (corner.z() > foot && object == static_cast<size_t>(e.object)) add(corner, feet_);
    if (std::min(e.from.z(), e.to.z()) > foot) add_foot(e, buildings_[object]);
  });
  index_buildings();
  for (const Edge& e : edges)
    if (e.object == Edge::kGround) add(e.from, terrain_), add(e.to, terrain_);
}

void Ground::add_foot(const Edge& edge, Foot& foot) {
  const Eigen::Vector2f a = edge.from.head<2>().cast<float>(), b = edge.to.head<2>().cast<float>();
  if (foot.edges.empty()) foot.low = foot.high = a;
  foot.low = foot.low.cwiseMin(a.cwiseMin(b)), foot.high = foot.high.cwiseMax(a.cwiseMax(b));
  foot.edges.push_back({a, b});
}

/// Whether the edges form rings: an even number of them ends at each corner. An open outline has no inside.
bool Ground::is_closed(const Foot& foot) {
  std::vector<std::pair<float, float>> ends;
  for (const auto& edge : foot.edges)
    for (const Eigen::Vector2f& end : edge) ends.emplace_back(end.x(), end.y());
  std::sort(ends.begin(), ends.end());
  for (size_t i = 0; i < ends.size(); i += 2)
    if (i + 1 == ends.size() || ends[i] != ends[i + 1]) return false;
  return true;
}

void Ground::index_buildings() {
  for (uint32_t i = 0; i < buildings_.size(); ++i) {
    const Foot& foot = buildings_[i];
    if (foot.edges.empty() || !is_closed(foot) ||
        (foot.high - foot.low).maxCoeff() > 100 * static_cast<float>(p_.cell_m))
      continue;
    const auto cell = [&](float m) { return std::floor(static_cast<double>(m) / p_.cell_m); };
    for (double a = cell(foot.low.x()); a <= cell(foot.high.x()); ++a)
      for (double b = cell(foot.low.y()); b <= cell(foot.high.y()); ++b)
        buildings_of_[cell_of((a + 0.5) * p_.cell_m, (b + 0.5) * p_.cell_m)].push_back(i);
  }
}

bool Ground::is_built(const Eigen::Vector2d& north_east) const {
  const auto cell = buildings_of_.find(cell_of(north_east.x(), north_east.y()));
  if (cell == buildings_of_.end()) return false;
  const Eigen::Vector2f p = north_east.cast<float>();
  return std::any_of(cell->second.begin(), cell->second.end(), [&](uint32_t i) {
    bool inside = false;  // parity of the edges that a ray to the north crosses
    for (const auto& [a, b] : buildings_[i].edges) {
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      inside ^= a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()) > p.x();
    }
    return inside;
  });
}

int64_t Ground::cell_of(double north, double east) const {
  const auto a = static_cast<int64_t>(std::floor(north / p_.cell_m)),
             b = static_cast<int64_t>(std::floor(east / p_.cell_m));
  return a * (int64_t{1} << 32) + b;
}

void Ground::add(const Eigen::Vector3d& p_n, Cells& to) const {
  to[cell_of(p_n.x(), p_n.y())].push_back(
      {static_cast<float>(p_n.x()), static_cast<float>(p_n.y()), static_cast<float>(p_n.z())});
}

/// The points within reach, with weights that sum to 1: their inverse squared distances.
std::vector<Ground::Weighted> Ground::around(const Cells& cells, const Eigen::Vector2d& at, double reach_m) const {
  const int reach = static_cast<int>(std::ceil(reach_m / p_.cell_m));
  std::vector<Weighted> points;
  double all = 0;
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b) {
      const auto cell = cells.find(cell_of(at.x() + a * p_.cell_m, at.y() + b * p_.cell_m));
      if (cell == cells.end()) continue;
      for (const Point& p : cell->second) {
        const double d = std::hypot(static_cast<double>(p.north) - at.x(), static_cast<double>(p.east) - at.y());
        if (d > reach_m) continue;
        points.push_back({static_cast<double>(p.down), 1 / (d * d + p_.near_m * p_.near_m)});
        all += points.back().weight;
      }
    }
  for (Weighted& p : points) p.weight /= all;
  return points;
}

std::optional<Ground::At> Ground::at(const Eigen::Vector2d& north_east) const {
  // Of the terrain a low quantile: with trees and shrubs in it, a mean is up to three metres too high.
  auto terrain = around(terrain_, north_east, p_.terrain_m);
  std::sort(terrain.begin(), terrain.end(), [](const auto& x, const auto& y) { return x.down_m > y.down_m; });
  double below = 0;
  for (const Weighted& p : terrain)
    if ((below += p.weight) >= p_.low_part || &p == &terrain.back()) return At{p.down_m, true};
  const auto feet = around(feet_, north_east, p_.reach_m);
  if (feet.empty()) return std::nullopt;
  double mean = 0;
  for (const Weighted& p : feet) mean += p.weight * p.down_m;
  return At{mean, false};
}

CameraHeights::CameraHeights(const Ground& ground, const Eigen::Vector3d& p_n, std::optional<double> eye_m,
                             double reach_m, double step_m)
    : step_m_(step_m) {
  const auto reach = static_cast<Eigen::Index>(std::ceil(reach_m / step_m));
  downs_.resize(2 * reach + 1, 2 * reach + 1);
  const auto here = ground.at(p_n.head<2>());
  const double above_m = eye_m.value_or(here ? here->down_m - p_n.z() : 0);
  for (Eigen::Index a = -reach; a <= reach; ++a)
    for (Eigen::Index b = -reach; b <= reach; ++b) {
      const Eigen::Vector2d by(static_cast<double>(a) * step_m, static_cast<double>(b) * step_m);
      const auto there = ground.at(p_n.head<2>() + by);
      downs_(a + reach, b + reach) = there && (here || eye_m) ? there->down_m - above_m : p_n.z();
    }
}

double CameraHeights::down_m(double north, double east) const {
  const Eigen::Index reach = downs_.rows() / 2;
  const double last = static_cast<double>(2 * reach) - 1e-6;
  const double x = std::clamp(north / step_m_ + static_cast<double>(reach), 0.0, last);
  const double y = std::clamp(east / step_m_ + static_cast<double>(reach), 0.0, last);
  const auto a = static_cast<Eigen::Index>(x), b = static_cast<Eigen::Index>(y);
  const double u = x - static_cast<double>(a), v = y - static_cast<double>(b);
  return (1 - u) * ((1 - v) * downs_(a, b) + v * downs_(a, b + 1)) +
         u * ((1 - v) * downs_(a + 1, b) + v * downs_(a + 1, b + 1));
}

}  // namespace odograph::skyline
