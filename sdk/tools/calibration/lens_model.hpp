// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace odograph {

enum class Lens { pinhole, kannala_brandt };

/// Projects normalised image coordinates (x/z, y/z) to pixels with OpenCV's models. `lens` contains fx, fy, cx, cy and
/// then `coefficients` distortion coefficients in OpenCV's order; missing ones are 0. For doubles and Ceres' Jets.
/// [any]
template <class T>
std::array<T, 2> project(Lens model, const T* lens, size_t coefficients, const T& x, const T& y) {
  using std::atan, std::sqrt;
  const auto k = [&](size_t i) { return i < coefficients ? lens[4 + i] : T(0); };
  const T r2 = x * x + y * y;
  T dx = x, dy = y;
  if (model == Lens::kannala_brandt) {
    if (r2 > T(1e-16)) {
      const T r = sqrt(r2), theta = atan(r), t2 = theta * theta;
      const T scale = theta * (T(1) + t2 * (k(0) + t2 * (k(1) + t2 * (k(2) + t2 * k(3))))) / r;
      dx *= scale, dy *= scale;
    }
  } else {
    const T radial = (T(1) + r2 * (k(0) + r2 * (k(1) + r2 * k(4)))) / (T(1) + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
    const T xy = T(2) * x * y;
    dx = radial * x + (k(2) * xy + k(3) * (r2 + T(2) * x * x));
    dy = radial * y + (k(2) * (r2 + T(2) * y * y) + k(3) * xy);
  }
  return {lens[0] * dx + lens[2], lens[1] * dy + lens[3]};
}

}  // namespace odograph
