// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/inertial/window.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace odograph::inertial_scale {

using Eigen::Vector3d;

/// Orthonormal basis B of 1, t, t^2, t^3 at the frames: P = I - B B'.
Window::Basis Window::basis() const {
  Basis basis;
  Eigen::Matrix4d G = Eigen::Matrix4d::Zero();
  for (size_t i = 0; i < count_; ++i) {
    const double x = 2 * frames_[i].t_s / last_s() - 1;
    basis[i] = {1, x, x * x, x * x * x};
    G += basis[i] * basis[i].transpose();
  }
  const Eigen::LLT<Eigen::Matrix4d> llt(G);
  for (size_t i = 0; i < count_; ++i) basis[i] = llt.matrixL().solve(basis[i]);
  return basis;
}

Window::Vectors Window::detrended(const Basis& basis, Vector3d Frame::*values) const {
  Eigen::Matrix<double, 4, 3> trend = Eigen::Matrix<double, 4, 3>::Zero();  // by axis
  for (size_t i = 0; i < count_; ++i) trend += basis[i] * (frames_[i].*values).transpose();
  Vectors left;
  for (size_t i = 0; i < count_; ++i) left[i] = frames_[i].*values - trend.transpose() * basis[i];
  return left;
}

double Window::product(const Vectors& one, const Vectors& other) const {
  double sum = 0;
  for (size_t i = 0; i < count_; ++i) sum += one[i].dot(other[i]);
  return sum;
}

/// v'Cv
double Window::correlated(const Vectors& values, double tau_s) const {
  double sum = 0;
  for (size_t i = 0; i < count_; ++i) {
    sum += values[i].squaredNorm();
    for (size_t k = 0; k < i; ++k)
      sum += 2 * std::exp((frames_[k].t_s - frames_[i].t_s) / tau_s) * values[i].dot(values[k]);
  }
  return sum;
}

/// 3 tr(P C)
double Window::freedom(const Basis& basis, double tau_s) const {
  double sum = 0;
  for (size_t i = 0; i < count_; ++i) {
    sum += 1 - basis[i].squaredNorm();
    for (size_t k = 0; k < i; ++k)
      sum -= 2 * std::exp((frames_[k].t_s - frames_[i].t_s) / tau_s) * basis[i].dot(basis[k]);
  }
  return 3 * sum;
}

std::optional<WindowScale> Window::solve() const {
  if (count_ < p_.min_frames) return std::nullopt;
  double path = 0;
  for (size_t i = 1; i < count_; ++i) path += (frames_[i].y_n - frames_[i - 1].y_n).norm();
  const Basis trend = basis();
  Vectors a = detrended(trend, &Frame::alpha_n);
  const Vectors y = detrended(trend, &Frame::y_n), b = detrended(trend, &Frame::beta_n);
  const double bb = product(b, b), by = product(b, y), along = bb > 0 ? product(a, b) / bb : 0;
  for (size_t i = 0; i < count_; ++i) a[i] -= along * b[i];
  const double aa = product(a, a), ay = product(a, y);
  if (!(aa > 0 && path > 0)) return std::nullopt;
  const double left = product(y, y) - ay * ay / aa - (bb > 0 ? by * by / bb : 0);
  const double squares = std::max(left, 3 * static_cast<double>(count_) * std::pow(p_.min_noise * path, 2));
  double variance = 0;
  for (const double tau_s : p_.tau_s) {
    const double aCa = correlated(a, tau_s), bCb = bb > 0 ? correlated(b, tau_s) / bb : 0;
    variance = std::max(variance, squares / (freedom(trend, tau_s) - aCa / aa - bCb) * aCa / (aa * aa));
  }
  return WindowScale{ay / aa, std::sqrt(variance), path};
}

}  // namespace odograph::inertial_scale
