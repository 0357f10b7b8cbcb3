// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/lens.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace odograph::vio {
namespace {

constexpr double kDifference = 1e-5;  // of normalized coordinates, for the numeric derivative of the lens

}  // namespace

void correct(CameraModel& lens, const LensVector& delta) {
  const double factor = std::exp(delta[0]);
  lens.fx *= factor, lens.fy *= factor;
  lens.cx += delta[1], lens.cy += delta[2];
  if (lens.coefficients.size() < 4) lens.coefficients.resize(4, 0.0);
  lens.coefficients[0] += delta[3], lens.coefficients[1] += delta[4];
}

Eigen::Vector2d change_lens(const Eigen::Vector2d& pixel, const CameraModel& taken_with, const CameraModel& in) {
  if (taken_with.distortion == in.distortion && taken_with.coefficients == in.coefficients)
    return {in.cx + (pixel.x() - taken_with.cx) * (in.fx / taken_with.fx),
            in.cy + (pixel.y() - taken_with.cy) * (in.fy / taken_with.fy)};
  std::vector<cv::Point2d> straight;
  taken_with.undistort({cv::Point2f(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()))}, straight);
  return in.project({straight[0].x, straight[0].y});
}

Projection project(const CameraModel& lens, const Eigen::Vector3d& y) {
  Projection out;
  const Eigen::Vector2d n = y.head<2>() / y.z(), dx(kDifference, 0), dy(0, kDifference);
  out.pixel = lens.project(n);
  Eigen::Matrix2d by_normalized;
  by_normalized.col(0) = (lens.project(n + dx) - lens.project(n - dx)) / (2 * kDifference);
  by_normalized.col(1) = (lens.project(n + dy) - lens.project(n - dy)) / (2 * kDifference);
  Eigen::Matrix<double, 2, 3> P;
  P << 1 / y.z(), 0, -n.x() / y.z(), 0, 1 / y.z(), -n.y() / y.z();
  out.by_point = by_normalized * P;
  out.by_lens.setZero();
  out.by_lens.col(0) = out.pixel - Eigen::Vector2d(lens.cx, lens.cy);
  out.by_lens(0, 1) = out.by_lens(1, 2) = 1;
  const double r2 = n.squaredNorm(), r = std::sqrt(r2);
  Eigen::Vector2d radial(r2, r2 * r2);
  if (lens.distortion == CameraModel::Distortion::kannala_brandt) {
    const double theta = std::atan(r), t3 = theta * theta * theta;
    radial = r > 1e-9 ? Eigen::Vector2d(t3 / r, t3 * theta * theta / r) : Eigen::Vector2d::Zero();
  } else if (lens.coefficients.size() >= 8) {  // the rational model's denominator
    const auto& k = lens.coefficients;
    radial /= std::max(0.1, 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  }
  const Eigen::Vector2d f(lens.fx, lens.fy);
  out.by_lens.col(3) = f.cwiseProduct(n) * radial[0];
  out.by_lens.col(4) = f.cwiseProduct(n) * radial[1];
  return out;
}

}  // namespace odograph::vio
