// SPDX-License-Identifier: Apache-2.0
//
// A photograph at a crossing of two streets.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "plugins/fix/skyline/photograph_matcher.hpp"

namespace odograph::skyline::test {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

/// A crossing of two streets: houses of various heights, each an object; `lift`: height errors of their roofs, m.
inline std::vector<Edge> a_crossing(const std::vector<double>& lift) {
  std::vector<Edge> edges;
  int object = 0;
  const auto house = [&](double north, double east, double a, double b, double height) {
    height += object < static_cast<int>(lift.size()) ? lift[static_cast<size_t>(object)] : 0;
    const Vector3d corners[] = {
        {north - a, east - b, 0}, {north + a, east - b, 0}, {north + a, east + b, 0}, {north - a, east + b, 0}};
    const Vector3d up(0, 0, -height);
    for (int i = 0; i < 4; ++i) {
      const Vector3d &p = corners[i], &q = corners[(i + 1) % 4];
      edges.push_back({p, q, object}), edges.push_back({p + up, q + up, object}), edges.push_back({p, p + up, object});
    }
    ++object;
  };
  const double heights[] = {11, 16, 9, 13, 18, 12, 8, 15, 10, 14};
  for (int side : {-1, 1})
    for (int i = 0; i < 5; ++i) {
      house(18 + 13 * i, side * 13.0, 6, 6, heights[(i + (side > 0 ? 5 : 0)) % 10]);
      house(-18 - 14 * i, side * 14.0, 6.5, 6, heights[(2 * i + 3) % 10]);
      house(side * 17.0, 22 + 12 * i, 5, 5.5, heights[(i + 7) % 10]);
      house(side * 17.0, -24 - 12 * i, 5, 5.5, heights[(3 * i + 1) % 10]);
    }
  return edges;
}

inline Quaterniond camera(double heading, double pitch, double roll = 0) {
  Eigen::Matrix3d R;
  R << -std::sin(heading), 0, std::cos(heading), std::cos(heading), 0, std::sin(heading), 0, 1, 0;
  return Quaterniond(R * Eigen::AngleAxisd(pitch, Vector3d::UnitX()) * Eigen::AngleAxisd(roll, Vector3d::UnitZ()));
}

/// The sky's edge in a picture of 70 by 54 degrees.
inline std::vector<SkyEdge> seen_in(const std::vector<Edge>& houses, const Vector3d& p_n, const Quaterniond& q_n_c) {
  City city(houses);
  city.select_near_edges(p_n, 1, 0.01);
  Horizon horizon;
  city.horizon(p_n, horizon);
  std::vector<SkyEdge> edges;
  for (size_t j = 0; j < Horizon::kDirections; ++j) {
    const double azimuth = (static_cast<double>(j) + 0.5) * 0.5 * kDegree;
    const auto ray = [&](double e) -> Vector3d {
      return q_n_c.conjugate() *
             Vector3d(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), -std::sin(e));
    };
    const auto inside = [](const Vector3d& r) {
      return r.z() > 0.1 && std::abs(r.x() / r.z()) < 0.70 && std::abs(r.y() / r.z()) < 0.51;
    };
    double top = 1.4;
    while (top > -0.5 && !inside(ray(top))) top -= 0.004;
    if (top < -0.4) continue;
    const double e = static_cast<double>(horizon.elevation[j]);
    if (e > top)
      edges.push_back({ray(top), false, true});
    else if (inside(ray(e)))
      edges.push_back({ray(e)});
  }
  return edges;
}

inline PhotographPrior prior_of(const Vector3d& p_n, const Quaterniond& q_n_c) {
  return {.p_n = p_n,
          .q_n_c = q_n_c,
          .sigma_m = 8,
          .yaw_sigma_rad = 15 * kDegree,
          .tilt_sigma_rad = 0.6 * kDegree,
          .eye_m = 1.6};
}

}  // namespace odograph::skyline::test
