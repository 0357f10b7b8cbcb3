// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/sky_finder.hpp"

/// Streets of boxes, and the view of their roofs from a camera in them.
namespace odograph::skyline::test {

inline constexpr double kDegree = std::numbers::pi / 180;

inline void add_box(std::vector<Edge>& edges, double north, double east, double a, double b, double height) {
  const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  Eigen::Vector3d roof[4];
  for (int i = 0; i < 4; ++i) roof[i] = {north + 0.5 * a * sign[i][0], east + 0.5 * b * sign[i][1], -height};
  for (int i = 0; i < 4; ++i) edges.push_back({roof[i], roof[(i + 1) % 4]});
}

/// Two rows of houses, `between` apart, along a street to the north.
inline std::vector<Edge> a_street(double between) {
  std::vector<Edge> edges;
  const double heights[] = {12, 15, 10.5, 14, 9, 13};
  for (int i = 0; i < 6; ++i) {
    add_box(edges, -50 + 18 * i, -0.5 * between - 6, 17 - i % 3, 12, heights[i]);
    add_box(edges, -45 + 17 * i, 0.5 * between + 7, 16 - i % 2, 14, heights[5 - i] + 1);
  }
  return edges;
}

/// The model's skyline in a picture that ends `lowest_deg` above the horizon, in the directions [first_deg, end_deg)
/// clockwise from north.
inline std::vector<SkyEdge> seen_from(const std::vector<Edge>& houses, const Eigen::Vector3d& p_n,
                                      const Eigen::Quaterniond& q_n_c, double lowest_deg = 10, double first_deg = 0,
                                      double end_deg = 360) {
  City city(houses);
  city.select_near_edges(p_n, 1, 0.05);
  Horizon horizon;
  city.horizon(p_n, horizon);
  std::vector<SkyEdge> edges;
  for (double degrees = first_deg + 0.25; degrees < end_deg; degrees += 0.5) {
    const auto j =
        static_cast<size_t>(std::lround(2 * degrees - 0.5) + 2 * Horizon::kDirections) % Horizon::kDirections;
    const double lowest = lowest_deg * kDegree, azimuth = degrees * kDegree;
    const double e = std::max(lowest, static_cast<double>(horizon.elevation[j]));
    const Eigen::Vector3d u(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), -std::sin(e));
    edges.push_back({q_n_c.conjugate() * u, e <= lowest});
  }
  return edges;
}

}  // namespace odograph::skyline::test
