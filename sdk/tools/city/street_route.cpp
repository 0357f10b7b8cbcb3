// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/street_route.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

#include <opencv2/imgproc.hpp>

#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A map of the free space of a model: rows go north, columns east.
class StreetMap {
 public:
  StreetMap(const CityModel& city, const StreetRouteParameters& p) : p_(p), low_(city.low.head<2>()) {
    const Vector2d size = (city.high - city.low).head<2>() / p.cell_m;
    cv::Mat free(static_cast<int>(size.x()) + 1, static_cast<int>(size.y()) + 1, CV_8U, cv::Scalar(255));
    const double margin = p.border_m / p.cell_m;
    Vector2d least = Vector2d::Constant(1e9), most = -least;
    for (const auto& face : city.faces) {
      if (!city.objects[face.object].is_building) continue;
      std::vector<cv::Point> corners;
      for (const Vector3d& corner : face.corners) {
        const Vector2d at = (corner.head<2>() - low_) / p.cell_m;
        corners.emplace_back(static_cast<int>(std::lround(at.y())), static_cast<int>(std::lround(at.x())));
        least = least.cwiseMin(at), most = most.cwiseMax(at);
      }
      cv::fillConvexPoly(free, corners, cv::Scalar(0));
    }
    cv::distanceTransform(free, clearance_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    clearance_ *= p.cell_m;
    for (int y = 0; y < free.rows; ++y)
      for (int x = 0; x < free.cols; ++x)
        if (y < least.x() + margin || y > most.x() - margin || x < least.y() + margin || x > most.y() - margin)
          clearance_.at<float>(y, x) = 0;
  }

  bool is_street(int cell) const {
    const auto clearance = static_cast<double>(clearance_.ptr<float>()[cell]);
    return clearance >= p_.clearance_m && clearance <= p_.built_up_m;
  }
  int cells() const { return clearance_.rows * clearance_.cols; }
  Vector2d place(int cell) const { return low_ + p_.cell_m * Vector2d(cell / clearance_.cols, cell % clearance_.cols); }
  bool clear(const Vector2d& a, const Vector2d& b) const {
    const int n = static_cast<int>((b - a).norm() / (0.5 * p_.cell_m)) + 1;
    for (int i = 0; i <= n; ++i) {
      const Vector2d at = (a + (b - a) * i / n - low_) / p_.cell_m;
      const int y = static_cast<int>(std::lround(at.x())), x = static_cast<int>(std::lround(at.y()));
      if (y < 0 || x < 0 || y >= clearance_.rows || x >= clearance_.cols) return false;
      if (static_cast<double>(clearance_.at<float>(y, x)) < p_.clearance_m - p_.cell_m) return false;
    }
    return true;
  }

  /// Least-cost paths from a cell to all others that are not `used`: the predecessor of each, and the length in metres.
  void paths(int from, const std::vector<char>& used, std::vector<int>& before, std::vector<float>& length) const {
    const auto n = static_cast<size_t>(cells());
    before.assign(n, -1), length.assign(n, 0);
    std::vector<float> cost(n, 1e30f);
    using Entry = std::pair<float, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    cost[static_cast<size_t>(from)] = 0;
    open.push({0.0f, from});
    const int columns = clearance_.cols;
    while (!open.empty()) {
      const auto [c, cell] = open.top();
      open.pop();
      if (c > cost[static_cast<size_t>(cell)]) continue;
      const int y = cell / columns, x = cell % columns;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if ((dy == 0 && dx == 0) || y + dy < 0 || x + dx < 0 || y + dy >= clearance_.rows || x + dx >= columns)
            continue;
          const int next = (y + dy) * columns + x + dx;
          const auto k = static_cast<size_t>(next);
          if (!is_street(next) || used[k]) continue;
          const auto step = static_cast<float>(p_.cell_m * std::hypot(dy, dx));
          const double clearance = std::min(p_.middle_m, static_cast<double>(clearance_.ptr<float>()[next]));
          const float to = c + step * static_cast<float>(1 + 3 * (p_.middle_m - clearance) / p_.middle_m);
          if (to >= cost[k]) continue;
          cost[k] = to, before[k] = cell, length[k] = length[static_cast<size_t>(cell)] + step;
          open.push({to, next});
        }
    }
  }

 private:
  StreetRouteParameters p_;
  Vector2d low_;
  cv::Mat clearance_;
};

/// Simplifies a path to the points needed to stay near it and clear of walls.
std::vector<Vector2d> straightened(const StreetMap& map, const std::vector<Vector2d>& path, double tolerance_m) {
  std::vector<Vector2d> line = {path.front()};
  for (size_t from = 0; from + 1 < path.size();) {
    size_t to = from + 1;
    for (size_t end = from + 2; end < path.size(); ++end) {
      const Vector2d along = (path[end] - path[from]).normalized();
      double worst = 0;
      for (size_t i = from + 1; i < end; ++i) {
        const Vector2d d = path[i] - path[from];
        worst = std::max(worst, std::abs(d.x() * along.y() - d.y() * along.x()));
      }
      if (worst > tolerance_m * 2) break;
      if (worst <= tolerance_m && map.clear(path[from], path[end])) to = end;
    }
    line.push_back(path[to]);
    from = to;
  }
  return line;
}

}  // namespace

Result<std::vector<Vector3d>> draw_street_route(const CityModel& city, uint64_t seed, const StreetRouteParameters& p) {
  const StreetMap map(city, p);
  std::vector<int> streets;
  for (int cell = 0; cell < map.cells(); ++cell)
    if (map.is_street(cell)) streets.push_back(cell);
  if (streets.empty()) return Failure{ODO_E_DATA, "the model has no streets"};
  Random random(seed, 171);
  std::vector<int> before;
  std::vector<float> length;
  const std::vector<char> none(static_cast<size_t>(map.cells()), 0);
  for (int attempt = 0; attempt < 200; ++attempt) {
    std::vector<char> used = none;
    int at = streets[random.next() % streets.size()];
    std::vector<Vector2d> path = {map.place(at)};
    double so_far = 0;
    for (int leg = 0; leg < 4 && so_far < p.length_m; ++leg) {
      map.paths(at, used, before, length);
      const auto least = static_cast<float>(leg < 3 ? 60 : p.length_m - so_far);
      std::vector<int> targets;
      for (const int cell : streets)
        if (before[static_cast<size_t>(cell)] >= 0 && length[static_cast<size_t>(cell)] >= least)
          targets.push_back(cell);
      if (targets.empty()) break;
      std::vector<int> cells;
      for (int cell = targets[random.next() % targets.size()]; cell != at; cell = before[static_cast<size_t>(cell)])
        cells.push_back(cell);
      std::reverse(cells.begin(), cells.end());
      for (const int cell : cells) {
        so_far += (map.place(cell) - path.back()).norm();
        path.push_back(map.place(cell));
        at = cell;
        if (so_far >= p.length_m) break;
      }
      // Exclude the cells behind, so that the route does not return along itself.
      for (const int cell : streets)
        for (size_t i = 0; i + 12 < path.size(); i += 4)
          if ((map.place(cell) - path[i]).norm() < 6) used[static_cast<size_t>(cell)] = 1;
    }
    if (so_far < p.length_m) continue;
    const auto line = straightened(map, path, p.corner_tolerance_m);
    std::vector<Vector3d> points;
    for (const Vector2d& q : line) points.emplace_back(q.x(), q.y(), 0);
    return points;
  }
  return Failure{ODO_E_DATA, "no route of that length through the model's streets"};
}

double ground_up_m(const CityModel& city, const Vector2d& at) {
  constexpr double kReach_m = 40;
  double terrain = -1e9, foot = 1e9;
  for (const auto& face : city.faces) {
    const auto& c = face.corners;
    if (city.objects[face.object].is_building) {
      for (const Vector3d& corner : c)
        if ((corner.head<2>() - at).norm() < kReach_m) foot = std::min(foot, -corner.z());
      continue;
    }
    const Vector2d u = (c[1] - c[0]).head<2>(), v = (c[2] - c[0]).head<2>(), w = at - c[0].head<2>();
    const double det = u.x() * v.y() - u.y() * v.x();
    if (std::abs(det) < 1e-9) continue;
    const double a = (w.x() * v.y() - w.y() * v.x()) / det, b = (u.x() * w.y() - u.y() * w.x()) / det;
    if (a < 0 || b < 0 || a + b > 1) continue;
    terrain = std::max(terrain, -(c[0].z() + a * (c[1] - c[0]).z() + b * (c[2] - c[0]).z()));
  }
  if (terrain > -1e8) return terrain;
  return foot < 1e8 ? foot : 0;
}

}  // namespace odograph
