// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/walk_direction.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "sdk/math/scalar.hpp"

namespace odograph::steps {

void WalkDirection::add(const Eigen::Vector2d& surge_n, double phone_heading_rad) {
  const double keep = std::exp(-1 / p_.steps);
  sum_ = keep * sum_ + Eigen::Rotation2Dd(-phone_heading_rad) * surge_n;
  weights_ = keep * weights_ + surge_n.norm();
  squared_weights_ = keep * squared_weights_ + surge_n.squaredNorm();
}

double WalkDirection::offset_rad() const { return std::atan2(sum_.y(), sum_.x()); }

double WalkDirection::sigma_rad() const {
  const double length = sum_.norm();
  if (!(length > 0) || !(weights_ > 0)) return kPi;
  // The surges scatter; the ratio of the resultant to the summed length measures it (Mardia & Jupp 2000).
  const double part = std::min(1.0, length / weights_), effective = weights_ * weights_ / squared_weights_;
  const double scatter = (1 - part * part) / (2 * part * part);
  return std::min(kPi, std::sqrt(p_.min_sigma_rad * p_.min_sigma_rad + scatter / effective));
}

}  // namespace odograph::steps
