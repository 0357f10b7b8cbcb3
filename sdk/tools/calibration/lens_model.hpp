// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>

namespace odograph {

enum class Lens { pinhole, kannala_brandt };

/// Projects normalised image coordinates (x/z, y/z) to pixels with OpenCV's models. `lens` contains fx, fy, cx, cy and
/// then `coefficients` distortion coefficients in OpenCV's order; missing ones are 0. For doubles and Ceres' Jets.
/// [any]
template <class T>
Eigen::Matrix<T, 2, 1> project(Lens model, const T* lens, size_t coefficients, const Eigen::Matrix<T, 2, 1>& p) {
  using std::atan, std::sqrt;
  const auto k = [&](size_t i) { return i < coefficients ? lens[4 + i] : T(0); };
  const T r2 = p.squaredNorm();
  Eigen::Matrix<T, 2, 1> d = p;
  if (model == Lens::kannala_brandt) {
    if (r2 > T(1e-16)) {
      const T r = sqrt(r2), theta = atan(r), t2 = theta * theta;
      d *= theta * (T(1) + t2 * (k(0) + t2 * (k(1) + t2 * (k(2) + t2 * k(3))))) / r;
    }
  } else {
    const T radial = (T(1) + r2 * (k(0) + r2 * (k(1) + r2 * k(4)))) / (T(1) + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
    const T xy = T(2) * p.x() * p.y();
    d = radial * p + Eigen::Matrix<T, 2, 1>(k(2) * xy + k(3) * (r2 + T(2) * p.x() * p.x()),
                                            k(2) * (r2 + T(2) * p.y() * p.y()) + k(3) * xy);
  }
  return {lens[0] * d.x() + lens[2], lens[1] * d.y() + lens[3]};
}

}  // namespace odograph
