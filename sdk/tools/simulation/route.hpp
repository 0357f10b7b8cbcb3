// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace odograph {

/// A path through given points (north, east, up; m) with rounded corners.
class Route {
 public:
  /// The route at a distance along it.
  struct Place {
    Eigen::Vector2d north_east;
    double up = 0.0;       ///< of the ground, m; linear between points
    double heading = 0.0;  ///< rad, from north to east, without jumps of 2 pi
    double slope = 0.0;    ///< rise over run
  };
  /// At least two distinct points; arcs are smaller where a leg is too short for `corner_radius_m`.
  Route(const std::vector<Eigen::Vector3d>& points, double corner_radius_m);

  Place at(double s_m) const;  ///< extended straight before the start and beyond the end
  double length() const { return length_; }
  double curvature_at(double s_m) const;  ///< 1/m, positive to the right
  /// Ground heights at every metre along the route, at least one; linear between them.
  void set_heights(const std::vector<double>& up_m);
  const std::vector<Eigen::Vector3d>& points() const { return points_; }

 private:
  struct Piece {
    double start;  // along the route
    double length;
    Eigen::Vector2d from;
    double heading;
    double curvature;  // 1/m, positive to the right
  };
  struct Height {
    double s, up;
  };
  void add(double length, double curvature);

  std::vector<Eigen::Vector3d> points_;
  std::vector<Piece> pieces_;
  std::vector<Height> heights_;
  double length_ = 0.0;
};

}  // namespace odograph
