// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/patch.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace odograph::vio {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr int kSide = Patch::kSide, kHalf = kSide / 2;

/// Samples grey levels under `map`, bilinear. False if the patch leaves the picture.
bool sample(const cv::Mat& picture, const Patch::Map& map, int half, float* out) {
  const double reach = half;
  const Vector2d extent = reach * map.A.cwiseAbs().rowwise().sum();
  if (!(map.at.x() - extent.x() >= 0 && map.at.y() - extent.y() >= 0 && map.at.x() + extent.x() < picture.cols - 1 &&
        map.at.y() + extent.y() < picture.rows - 1))
    return false;
  const auto dx = static_cast<float>(map.A(0, 0)), dy = static_cast<float>(map.A(1, 0));
  for (int v = -half; v <= half; ++v) {
    const Vector2d start = map.at + map.A * Vector2d(-reach, v);
    const auto x0 = static_cast<float>(start.x()), y0 = static_cast<float>(start.y());
    for (int u = 0; u <= 2 * half; ++u) {
      const float x = x0 + static_cast<float>(u) * dx, y = y0 + static_cast<float>(u) * dy;
      const int column = static_cast<int>(x), row = static_cast<int>(y);
      const float a = x - static_cast<float>(column), b = y - static_cast<float>(row);
      const uchar* top = picture.ptr<uchar>(row) + column;
      const uchar* bottom = top + picture.step;
      const float upper = static_cast<float>(top[0]) + a * static_cast<float>(top[1] - top[0]);
      const float lower = static_cast<float>(bottom[0]) + a * static_cast<float>(bottom[1] - bottom[0]);
      *out++ = upper + b * (lower - upper);
    }
  }
  return true;
}

}  // namespace

bool Patch::store(const cv::Mat& picture, const Vector2d& at, const Parameters& p) {
  constexpr int kWide = kSide + 2;
  Eigen::Matrix<float, kWide, kWide, Eigen::RowMajor> wide;
  if (!sample(picture, {at, Matrix2d::Identity()}, kHalf + 1, wide.data())) return false;
  Eigen::Matrix2d gradients = Eigen::Matrix2d::Zero();
  int k = 0;
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u, ++k) {
      values_[k] = wide(v + 1, u + 1);
      const float gx = 0.5F * (wide(v + 1, u + 2) - wide(v + 1, u)), gy = 0.5F * (wide(v + 2, u + 1) - wide(v, u + 1));
      const auto x = static_cast<float>(u - kHalf), y = static_cast<float>(v - kHalf);
      derivatives_.row(k) << gx * x, gy * x, gx * y, gy * y, gx, gy;
      const Vector2d g(gx, gy);
      gradients += g * g.transpose();
    }
  values_.array() -= values_.mean();
  const float squares = values_.squaredNorm();
  contrast_ = std::sqrt(squares / kPixels);
  const double trace = gradients.trace() / kPixels, det = gradients.determinant() / (kPixels * kPixels);
  const double least = 0.5 * (trace - std::sqrt(std::max(0.0, trace * trace - 4 * det)));
  if (contrast_ < p.min_contrast || least < p.min_gradient * p.min_gradient) return false;
  derivatives_.rowwise() -= derivatives_.colwise().mean().eval();
  derivatives_ -= values_ * ((values_.transpose() * derivatives_) / squares).eval();
  H_ = (derivatives_.transpose() * derivatives_).cast<double>();
  return true;
}

std::optional<Patch::Match> Patch::find(const cv::Mat& picture, const Map& guess, const Parameters& p) const {
  Match match{guess, 0};
  Values now;
  Eigen::Matrix<double, 6, 6> H = H_;
  const double prior = p.grey_sigma * p.grey_sigma / (p.affine_sigma * p.affine_sigma);
  H.diagonal().head<4>().array() += prior;
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(H);
  Vector6d total = Vector6d::Zero();
  for (int iteration = 0; iteration < p.iterations; ++iteration) {
    if (!sample(picture, match.map, kHalf, now.data())) return std::nullopt;
    now.array() -= now.mean();
    const double gain = contrast_ * std::sqrt(static_cast<double>(kPixels)) / std::max(1e-3F, now.norm());
    now = now * static_cast<float>(std::clamp(gain, 0.3, 3.0)) - values_;
    match.difference = now.cwiseAbs().mean();
    Vector6d g = (derivatives_.transpose() * now).cast<double>();
    g.head<4>() -= prior * total.head<4>();
    const Vector6d step = solver.solve(g);
    total += step;  // the template's step is added: valid for small changes of the map
    Matrix2d D = Matrix2d::Identity();
    D += Eigen::Map<const Matrix2d>(step.data());
    if (!(std::abs(D.determinant()) > 0.1)) return std::nullopt;
    match.map.A = match.map.A * D.inverse();
    const Vector2d shift = match.map.A * step.tail<2>();
    match.map.at -= shift;
    if (!match.map.at.allFinite()) return std::nullopt;
    if (shift.norm() < p.settled_px) return match;
  }
  return std::nullopt;
}

}  // namespace odograph::vio
