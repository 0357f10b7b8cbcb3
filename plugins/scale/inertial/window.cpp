// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/inertial/window.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace odograph::inertial_scale {

using Eigen::Vector3d;
using Eigen::Vector4d;

void Window::add(double t_s, const Vector3d& alpha_n, const Vector3d& y_n) {
  if (count_ < frames_.size()) frames_[count_++] = {t_s, alpha_n, y_n};
}

std::optional<WindowScale> Window::solve() const {
  if (count_ < p_.min_frames) return std::nullopt;
  const double half_s = 0.5 * last_s();
  const auto basis = [&](const Frame& f) {
    const double x = f.t_s / half_s - 1;
    return Vector4d(1, x, x * x, x * x * x);
  };
  Eigen::Matrix4d G = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> by_alpha, by_y;  // columns: axes
  by_alpha.setZero(), by_y.setZero();
  double path = 0;
  for (size_t i = 0; i < count_; ++i) {
    const Vector4d b = basis(frames_[i]);
    G += b * b.transpose();
    by_alpha += b * frames_[i].alpha_n.transpose();
    by_y += b * frames_[i].y_n.transpose();
    if (i > 0) path += (frames_[i].y_n - frames_[i - 1].y_n).norm();
  }
  const Eigen::LDLT<Eigen::Matrix4d> ldlt(G);
  const Eigen::Matrix<double, 4, 3> trend_alpha = ldlt.solve(by_alpha), trend_y = ldlt.solve(by_y);
  double aa = 0, ay = 0, yy = 0;
  for (size_t i = 0; i < count_; ++i) {
    const Vector4d b = basis(frames_[i]);
    const Vector3d alpha = frames_[i].alpha_n - trend_alpha.transpose() * b;
    const Vector3d y = frames_[i].y_n - trend_y.transpose() * b;
    aa += alpha.squaredNorm(), ay += alpha.dot(y), yy += y.squaredNorm();
  }
  if (!(aa > 0 && path > 0)) return std::nullopt;
  const double n = static_cast<double>(count_), freedom = 3 * (n - 4) - 1, r = ay / aa;
  const double noise = std::max(std::sqrt(std::max(0.0, yy - r * ay) / freedom), p_.min_noise * path);
  const double same = std::max(1.0, p_.correlation_s * n / (2 * half_s));  // frames that share one error
  return WindowScale{r, noise * std::sqrt(same / aa)};
}

}  // namespace odograph::inertial_scale
