// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/straight_edges.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace odograph::skyline {
namespace {

constexpr size_t kShortest = 6;  // directions of an edge, three degrees: any two are on a great circle

}  // namespace

std::vector<int> straight_edges(const std::vector<SkyEdge>& directions, const std::vector<double>& weights,
                                const StraightEdgeCosts& c) {
  const size_t n = directions.size();
  // Of the first directions: sums, and the shortest description and where its last edge starts.
  std::vector<Eigen::Matrix3d> squares(n + 1, Eigen::Matrix3d::Zero());
  std::vector<double> weight(n + 1, 0), shortest(n + 1, 0);
  std::vector<size_t> from(n + 1, 0);
  size_t line = 0;  // first direction of a line without a gap
  for (size_t end = 1; end <= n; ++end) {
    const Eigen::Vector3d& ray = directions[end - 1].ray_c;
    const double w = weights[end - 1];
    squares[end] = squares[end - 1] + w * ray * ray.transpose(), weight[end] = weight[end - 1] + w;
    from[end] = end - 1, shortest[end] = shortest[end - 1] + w * c.ragged;
    if (!(w > 0)) line = end;
    for (size_t k = line; k + kShortest <= end; ++k) {
      const double exact = shortest[k] + c.edge + c.exact * (weight[end] - weight[k]);
      if (exact >= shortest[end]) continue;
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> plane;
      plane.computeDirect(squares[end] - squares[k], Eigen::EigenvaluesOnly);
      const double off = std::max(0.0, plane.eigenvalues()[0]) / (c.sigma_rad * c.sigma_rad);
      if (exact + 0.5 * c.part * off < shortest[end]) shortest[end] = exact + 0.5 * c.part * off, from[end] = k;
    }
  }
  std::vector<int> edge(n, kRagged);
  int number = 0;
  for (size_t end = n; end > 0; end = from[end]) {
    if (from[end] + 1 == end) continue;
    std::fill(edge.begin() + static_cast<std::ptrdiff_t>(from[end]), edge.begin() + static_cast<std::ptrdiff_t>(end),
              number++);
  }
  return edge;
}

}  // namespace odograph::skyline
