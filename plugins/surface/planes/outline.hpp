// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace odograph::planes {

/// Replaces points by their convex hull, counterclockwise (Andrew 1979), of at most 32 vertices: those that add least
/// are left out. Allocates nothing if there is capacity for three times as many points.
void make_hull(std::vector<Eigen::Vector2d>& points);

/// Distance outside of a convex outline, m; 0 inside.
double outside(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p);

/// Smallest distance between two parallels that enclose a convex outline, m.
double width_of(const std::vector<Eigen::Vector2d>& outline);

/// m^2.
double area_of(const std::vector<Eigen::Vector2d>& outline);

}  // namespace odograph::planes
