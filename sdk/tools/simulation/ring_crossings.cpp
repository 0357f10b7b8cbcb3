// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// An edge projected along the polygon's normal; `ring` and `place` identify neighbours.
struct FlatEdge {
  Vector2d from, to;
  size_t ring, place;
  double low_x() const { return std::min(from.x(), to.x()); }
  double high_x() const { return std::max(from.x(), to.x()); }
};

double side(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
}

bool meet(const FlatEdge& a, const FlatEdge& b) {
  const auto low = [](const FlatEdge& e) { return std::min(e.from.y(), e.to.y()); };
  const auto high = [](const FlatEdge& e) { return std::max(e.from.y(), e.to.y()); };
  if (low(a) > high(b) || low(b) > high(a)) return false;
  return side(a.from, a.to, b.from) * side(a.from, a.to, b.to) <= 0 &&
         side(b.from, b.to, a.from) * side(b.from, b.to, a.to) <= 0;
}

}  // namespace

bool spend_crossings(const std::vector<std::vector<Vector3d>>& rings, CrossingBudget& budget) {
  if (rings.empty() || (rings.size() == 1 && rings[0].size() <= 3)) return true;
  Eigen::Index dropped = 2;
  newell_normal(rings[0]).cwiseAbs().maxCoeff(&dropped);
  std::vector<FlatEdge> edges;
  for (size_t r = 0; r < rings.size(); ++r)
    for (size_t i = 0; i < rings[r].size(); ++i) {
      const auto flat = [&](const Vector3d& p) { return Vector2d(p[(dropped + 1) % 3], p[(dropped + 2) % 3]); };
      edges.push_back({flat(rings[r][i]), flat(rings[r][(i + 1) % rings[r].size()]), r, i});
    }
  std::sort(edges.begin(), edges.end(), [](const FlatEdge& a, const FlatEdge& b) { return a.low_x() < b.low_x(); });
  const auto neighbours = [&](const FlatEdge& a, const FlatEdge& b) {
    const size_t n = rings[a.ring].size();
    return a.ring == b.ring && ((a.place + 1) % n == b.place || (b.place + 1) % n == a.place);
  };
  std::vector<const FlatEdge*> open;  // edges that cross the sweep line
  for (const FlatEdge& e : edges) {
    std::erase_if(open, [&](const FlatEdge* o) { return o->high_x() < e.low_x(); });
    if (open.size() > budget.pairs) return false;
    budget.pairs -= open.size();
    for (const FlatEdge* o : open) {
      if (neighbours(*o, e) || !meet(*o, e)) continue;
      if (budget.crossings == 0) return false;
      --budget.crossings;
    }
    open.push_back(&e);
  }
  return true;
}

}  // namespace odograph
