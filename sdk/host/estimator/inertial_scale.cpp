// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/estimator/inertial_scale.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace odograph::inertial {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

}  // namespace

void InertialScale::restart() {
  path_.clear();
  frame_count_ = 0;
  alpha_n_.setZero();
  rate_n_.setZero();
}

void InertialScale::add_imu(int64_t t_ns, double dt_s, const Vector3d& accel_n) {
  alpha_n_ += rate_n_ * dt_s + 0.5 * dt_s * dt_s * accel_n;
  rate_n_ += dt_s * accel_n;
  path_.add(t_ns, alpha_n_);
}

std::optional<WindowScale> InertialScale::add_frame(int64_t t_ns, const Vector3d& lever_n, const Vector3d& y_n,
                                                    double window_s) {
  const auto alpha_n = path_.at(t_ns, p_.reaches_back_ns);
  if (!alpha_n) return std::nullopt;
  if (frame_count_ == 0) first_ns_ = t_ns;
  const double t_s = static_cast<double>(t_ns - first_ns_) * 1e-9;
  if (frame_count_ > 0 && t_s - frames_[frame_count_ - 1].t_s < p_.window_spacing_s) return std::nullopt;
  if (frame_count_ == frames_.size()) frame_count_ = 0;
  frames_[frame_count_++] = {t_s, *alpha_n + lever_n, y_n};
  if (t_s < window_s) return std::nullopt;
  const auto scale = frame_count_ >= static_cast<size_t>(p_.window_min_frames) ? solve() : std::nullopt;
  restart();
  return scale;
}

std::optional<WindowScale> InertialScale::solve() const {
  const double half_s = 0.5 * frames_[frame_count_ - 1].t_s;
  const auto basis = [&](const Frame& f) {
    const double x = f.t_s / half_s - 1;
    return Vector3d(1, x, x * x);
  };
  Matrix3d G = Matrix3d::Zero(), by_alpha = Matrix3d::Zero(), by_y = Matrix3d::Zero();  // columns: axes
  for (size_t i = 0; i < frame_count_; ++i) {
    const Vector3d b = basis(frames_[i]);
    G += b * b.transpose();
    by_alpha += b * frames_[i].alpha_n.transpose();
    by_y += b * frames_[i].y_n.transpose();
  }
  const Eigen::LDLT<Matrix3d> ldlt(G);
  const Matrix3d trend_alpha = ldlt.solve(by_alpha), trend_y = ldlt.solve(by_y);
  double aa = 0, ay = 0, yy = 0;
  for (size_t i = 0; i < frame_count_; ++i) {
    const Vector3d b = basis(frames_[i]);
    const Vector3d alpha = frames_[i].alpha_n - trend_alpha.transpose() * b;
    const Vector3d y = frames_[i].y_n - trend_y.transpose() * b;
    aa += alpha.squaredNorm(), ay += alpha.dot(y), yy += y.squaredNorm();
  }
  const double n = static_cast<double>(frame_count_), freedom = 3 * (n - 3) - 1;
  if (aa <= 0 || ay <= 0) return std::nullopt;
  const double r = ay / aa, noise = std::sqrt(std::max(0.0, yy - r * ay) / freedom);
  const double same = std::max(1.0, p_.window_correlation_s * n / (2 * half_s));  // frames that share one error
  const double sigma = std::hypot(noise * std::sqrt(same / aa), p_.window_min_relative * r);
  return WindowScale{r, sigma, std::sqrt(aa / (3 * n)), noise / r};
}

}  // namespace odograph::inertial
