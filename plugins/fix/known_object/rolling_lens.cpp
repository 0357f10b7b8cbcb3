// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/rolling_lens.hpp"

#include "sdk/math/rotation.hpp"

namespace odograph::known_object {

using Eigen::Vector2d;
using Eigen::Vector3d;

Pose Pose::moved(const Eigen::Matrix<double, 6, 1>& theta_delta) const {
  const Eigen::Matrix3d R = exp_rotation_matrix(theta_delta.head<3>());
  return {R * R_c_o, R * t_c_o + theta_delta.tail<3>()};
}

std::optional<RollingLens::Seen> RollingLens::project(const Vector3d& p_c) const {
  constexpr double kWidest = 3.73, kStep = 1e-6;  // tan 75 deg
  const auto normalised = [](const Vector3d& p) { return Vector2d(p.x() / p.z(), p.y() / p.z()); };
  Vector3d p = p_c;
  if (p.z() < 1e-3 || normalised(p).norm() > kWidest) return {};
  Vector2d pixel = camera.project(normalised(p));
  if (line_time_s > 0) {  // twice: time and row depend on each other
    for (int pass = 0; pass < 2; ++pass) {
      const double after_s = (pixel.y() - 0.5 * (height - 1)) * line_time_s;
      p = p_c - after_s * (rate_c.cross(p_c) + velocity_c);
      if (p.z() < 1e-3 || normalised(p).norm() > kWidest) return {};
      pixel = camera.project(normalised(p));
    }
  }
  const Vector2d at = normalised(p);
  Eigen::Matrix2d by_normalised;
  for (int k = 0; k < 2; ++k) {
    const Vector2d step = kStep * Vector2d::Unit(k);
    by_normalised.col(k) = (camera.project(at + step) - camera.project(at - step)) / (2 * kStep);
  }
  Seen seen{pixel, {}};
  Eigen::Matrix<double, 2, 3> flat;
  flat << 1 / p.z(), 0, -at.x() / p.z(), 0, 1 / p.z(), -at.y() / p.z();
  seen.by_point = by_normalised * flat;
  return seen;
}

}  // namespace odograph::known_object
