// SPDX-License-Identifier: Apache-2.0
#include "plugins/scale/slant_distance/slant_scale.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "sdk/math/time.hpp"

namespace odograph::slant_scale {

using Eigen::Vector2d;

void SlantScale::add_motion(int64_t from_ns, int64_t t_ns, const Eigen::Vector3d& d_n, uint32_t group) {
  if (group_ != group) {
    group_ = group;
    path_.clear(), pairs_.clear();
    at_.setZero();
    scale_.reset();
    guess_s_ = 0;
    guessed_.clear();
    known_ = false;
  }
  const double dt = seconds(t_ns - from_ns), distance = d_n.head<2>().norm();
  guess(dt, distance);
  if (path_.empty()) path_.push_back({from_ns, at_});
  at_ += d_n.head<2>();
  path_.push_back({t_ns, at_});
  while (seconds(t_ns - path_.front().t_ns) > window_s_) path_.pop_front();
}

double SlantScale::RunningMedian::median() const {
  const size_t n = std::min(count_, values_.size());
  if (n == 0) return 0;
  std::array<double, 11> sorted = values_;
  std::nth_element(sorted.begin(), sorted.begin() + n / 2, sorted.begin() + n);
  return sorted[n / 2];
}

/// Until fixes give the new scale the speed is assumed unchanged, and compared with the motions of the first second.
void SlantScale::guess(double dt, double distance) {
  if (dt <= 0) return;
  if (known_) return speed_mps_.add(scale_->scale * distance / dt);
  const double speed = speed_mps_.median();
  if (speed < p_.standing_mps || distance < 1e-9 || guess_s_ >= p_.guess_s) return;
  guess_s_ += dt;
  guessed_.add(speed * dt / distance);
  scale_ = Scale{guessed_.median(), p_.guess * guessed_.median()};
}

void SlantScale::start_at(const Vector2d& p_n, double variance) {
  if (path_.empty() || !pairs_.empty()) return;
  pairs_.push_back({path_.front().t_ns, p_n, path_.front().p, variance});
}

void SlantScale::add_position(int64_t t_ns, const Vector2d& p_n, double variance) {
  const auto at =
      std::lower_bound(path_.begin(), path_.end(), t_ns, [](const Point& p, int64_t t) { return p.t_ns < t; });
  if (at == path_.end() || at->t_ns != t_ns) return;
  pairs_.push_back({t_ns, p_n, at->p, variance});
  while (seconds(t_ns - pairs_.front().t_ns) > window_s_) pairs_.pop_front();
  fit();
}

/// model = a + s R(angle) vo. The angle is fitted with the scale and discarded: heading is the coupling's task, and its
/// errors would make the line too short.
void SlantScale::fit() {
  if (pairs_.size() < 2) return;
  std::vector<double> weights(pairs_.size(), 1.0);
  double s = 0, sigma = 0;
  Vector2d spread_m = Vector2d::Zero();
  for (int iteration = 0; iteration < 4; ++iteration) {
    double total = 0;
    Vector2d mean_m = Vector2d::Zero(), mean_v = Vector2d::Zero();
    for (size_t i = 0; i < pairs_.size(); ++i) {
      const double w = weights[i] / pairs_[i].variance;
      total += w, mean_m += w * pairs_[i].model_m, mean_v += w * pairs_[i].vo;
    }
    mean_m /= total, mean_v /= total;
    double dot = 0, cross = 0, vv = 0;
    spread_m.setZero();
    for (size_t i = 0; i < pairs_.size(); ++i) {
      const Vector2d m = pairs_[i].model_m - mean_m, v = pairs_[i].vo - mean_v;
      const double w = weights[i] / pairs_[i].variance;
      dot += w * m.dot(v), cross += w * (v.x() * m.y() - v.y() * m.x()), vv += w * v.squaredNorm();
      spread_m = spread_m.cwiseMax(m.cwiseAbs());
    }
    const double length = std::hypot(dot, cross);
    if (vv <= 0 || length <= 0) return;
    s = length / vv;
    const double c = dot / length, t = cross / length;
    double chi = 0, n = 0;
    for (size_t i = 0; i < pairs_.size(); ++i) {
      const Vector2d v = pairs_[i].vo - mean_v;
      const Vector2d r = pairs_[i].model_m - mean_m - s * Vector2d(c * v.x() - t * v.y(), t * v.x() + c * v.y());
      const double z = r.norm() / std::sqrt(pairs_[i].variance);
      weights[i] = std::min(1.0, p_.huber / std::max(z, 1e-9));
      chi += weights[i] * z * z, n += 2;
    }
    sigma = std::sqrt(std::max(1.0, chi / std::max(1.0, n - 4)) / vv);
  }
  const Scale found{s, std::hypot(sigma, scale_drift_ * s)};
  if (pairs_.size() < 3 || 2 * spread_m.norm() < min_displacement_m_) {
    const bool better = !scale_ || found.sigma / found.scale < scale_->sigma / scale_->scale;
    if (!known_ && found.sigma < p_.first * found.scale && better) scale_ = found;
    return;  // nearly standing: the direction of the line is undefined
  }
  // A scale that doubles within a window is rejected as fixes of a similar place, unless it persists.
  const bool leaps = known_ && std::abs(std::log(s / scale_->scale)) > p_.max_jump;
  jumps_ = leaps ? jumps_ + 1 : 0;
  if (leaps && jumps_ < p_.confirmations) return;
  scale_ = found;
  known_ = true;
}

}  // namespace odograph::slant_scale
