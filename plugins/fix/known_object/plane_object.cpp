// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/plane_object.hpp"

#include <cmath>
#include <stdexcept>

namespace odograph::known_object {

using Eigen::Vector3d;

RadianLengths::RadianLengths(double latitude_rad) {
  constexpr double kEquator_m = 6378137.0, kEccentricity2 = 6.69437999014e-3;
  const double s = std::sin(latitude_rad), w = std::sqrt(1 - kEccentricity2 * s * s);
  north_m = kEquator_m * (1 - kEccentricity2) / (w * w * w);
  east_m = kEquator_m / w * std::cos(latitude_rad);
}

void place_by_corners(const std::array<Vector3d, 4>& c, PlaneObject& object) {
  const Vector3d right = 0.5 * (c[1] - c[0] + c[2] - c[3]), down = 0.5 * (c[0] - c[3] + c[1] - c[2]);
  object.width_m = right.norm(), object.height_m = down.norm();
  if (object.width_m < 0.02 || object.height_m < 0.02)
    throw std::runtime_error("object '" + object.id + "': smaller than 2 cm");
  const Vector3d middle = 0.25 * (c[0] + c[1] + c[2] + c[3]);
  Eigen::Matrix3d axes;
  axes.col(2) = right.cross(down).normalized();
  // Distributes the deviation from orthogonality evenly between both sides.
  const Vector3d diagonal = (right.normalized() + down.normalized()).normalized();
  const Vector3d other = axes.col(2).cross(diagonal);
  axes.col(0) = (diagonal - other).normalized();
  axes.col(1) = (diagonal + other).normalized();
  object.place.R_n_o = axes;
  if (!object.place.geodetic) object.place.p_n = middle;
  const double max_m = 5 * object.sigma_m + 0.01 * std::max(object.width_m, object.height_m);
  const auto ideal = object.corners_o();
  for (size_t k = 0; k < 4; ++k)
    if ((axes * ideal[k] + middle - c[k]).norm() > max_m)
      throw std::runtime_error(
          "object '" + object.id +
          "': its corners (lower left, lower right, upper right, upper left) do not form a rectangle");
}

}  // namespace odograph::known_object
