// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/sky_finder.hpp"

namespace odograph::skyline {

/// What is known before looking.
struct Prior {
  Eigen::Vector3d p_n;  ///< of the camera; the height is taken as it is
  Eigen::Quaterniond q_n_c;
  double position_sigma_m, yaw_sigma_rad, tilt_sigma_rad, farthest_m;
};

struct Match {
  Eigen::Vector3d p_n;
  Eigen::Quaterniond q_n_c;
  Eigen::Matrix2d covariance;  ///< of north and east, m^2
  double yaw_sigma_rad;
  double agreement;  ///< part of the directions in which picture and model agree
  double rival;      ///< likelihood of the best other place over that of this one
  /// The highest point of the skyline: eq. (2) and (4) of Gakne & O'Keefe 2018.
  Eigen::Vector3d landmark_n;
  double slant_distance_m;
};

/// Finds the place and the orientation whose skyline looks like the one in the picture. Where the paper correlates
/// binary images of a database of places, this compares the elevation at which the sky ends, direction by direction,
/// with the model's, computed where it is needed; the loss of a direction is bounded, because models miss trees and new
/// houses.
class Matcher {
 public:
  explicit Matcher(City city) : city_(std::move(city)) {}
  std::optional<Match> match(const std::vector<SkyEdge>& edges, const Prior& prior);

 private:
  struct Guess {
    double north = 0, east = 0, yaw = 0, tilt_north = 0, tilt_east = 0;  ///< from the prior
  };
  double cost(const Guess& guess, bool new_place);
  Eigen::Quaterniond turned(const Guess& guess) const;

  City city_;
  Prior prior_{};
  std::vector<Eigen::Vector3d> rays_n_;  // by the prior's orientation
  std::vector<char> open_;
  Horizon horizon_;
};

}  // namespace odograph::skyline
