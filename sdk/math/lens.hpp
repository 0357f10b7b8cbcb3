// SPDX-License-Identifier: Apache-2.0
//
// The two lens models of odo_calibration, in the order of OpenCV's coefficients; missing ones are zero.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Core>
#include <Eigen/LU>

namespace odograph {

struct LensCoefficients {
  const double* values;
  size_t count;
  double operator[](size_t i) const { return i < count ? values[i] : 0.0; }
};

/// Normalized coordinates (x/z, y/z) as a radial-tangential lens shows them.
inline Eigen::Vector2d radial_tangential(const Eigen::Vector2d& p, const LensCoefficients& k) {
  const double r2 = p.squaredNorm(), xy = 2 * p.x() * p.y();
  const double radial = (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  return radial * p +
         Eigen::Vector2d(k[2] * xy + k[3] * (r2 + 2 * p.x() * p.x()), k[2] * (r2 + 2 * p.y() * p.y()) + k[3] * xy);
}

/// Distance from the principal point of a Kannala-Brandt lens, in focal lengths, by the angle to the axis, rad.
inline double kannala_brandt(double theta, const LensCoefficients& k) {
  const double t2 = theta * theta;
  return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

/// Unit vector in the camera towards the normalized coordinates of a picture, ((column - cx) / fx, (row - cy) / fy), or
/// nothing if the lens shows nothing there.
inline std::optional<Eigen::Vector3d> ray_of(const Eigen::Vector2d& seen, bool is_kannala_brandt,
                                             const LensCoefficients& k) {
  constexpr double kClose = 1e-9, kStep = 1e-6, kFarthest = 3.1;  // rad or focal lengths; the last just below pi
  if (is_kannala_brandt) {
    const double radius = seen.norm();
    double theta = std::min(radius, kFarthest);
    for (int i = 0; i < 20 && std::abs(kannala_brandt(theta, k) - radius) > kClose; ++i) {
      const double slope = (kannala_brandt(theta + kStep, k) - kannala_brandt(theta - kStep, k)) / (2 * kStep);
      if (!(slope > 0)) return std::nullopt;
      theta = std::clamp(theta - (kannala_brandt(theta, k) - radius) / slope, 0.0, kFarthest);
    }
    if (!(std::abs(kannala_brandt(theta, k) - radius) < kStep)) return std::nullopt;
    const Eigen::Vector2d across = radius > 0 ? (std::sin(theta) / radius * seen).eval() : Eigen::Vector2d::Zero();
    return Eigen::Vector3d(across.x(), across.y(), std::cos(theta));
  }
  Eigen::Vector2d p = seen;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d off = radial_tangential(p, k) - seen;
    if (off.norm() < kClose) return Eigen::Vector3d(p.x(), p.y(), 1).normalized();
    Eigen::Matrix2d J;
    J.col(0) = (radial_tangential(p + Eigen::Vector2d(kStep, 0), k) - seen - off) / kStep;
    J.col(1) = (radial_tangential(p + Eigen::Vector2d(0, kStep), k) - seen - off) / kStep;
    if (!(J.determinant() > 0)) return std::nullopt;  // beyond the radius at which the polynomial turns back
    p -= J.inverse() * off;
  }
  return std::nullopt;
}

}  // namespace odograph
