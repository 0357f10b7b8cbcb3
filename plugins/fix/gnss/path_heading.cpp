// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/gnss/path_heading.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace odograph::gnss {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

constexpr double kAny = 3, kAny_m = 1e5, kJump_m = 50;  // of (a, b), of the path's beginning, of a reflection
constexpr int64_t kPatience_ns = 3'000'000'000, kVelocity_ns = 1'000'000'000;
constexpr size_t kKept = 64;            // steps and positions
constexpr double kTellable_rad = 0.35;  // a turn is told once it is as well known
constexpr double kNews = 0.3;           // and again when it has gained so much of its information
constexpr double kLeastScale = 0.3;     // of (a, b): below it has no direction yet

double seconds(int64_t ns) { return static_cast<double>(ns) * 1e-9; }
double wrapped(double rad) { return std::remainder(rad, 2 * std::numbers::pi); }

}  // namespace

PathHeading::PathHeading(const Parameters& parameters) : p_(parameters) {
  x_.setZero();
  P_.setZero();
  P_.diagonal() << kAny * kAny, kAny * kAny, kAny_m * kAny_m, kAny_m * kAny_m, 0, 0, 0, 0;
}

void PathHeading::add_step(int64_t start_ns, int64_t end_ns, double length_m, double heading_rad) {
  if (end_ns <= start_ns || !(length_m > 0)) return;
  const Vector2d by = length_m * Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  steps_.push_back({start_ns, end_ns, path_, by});
  path_ += by;
  if (steps_.size() > kKept) steps_.pop_front();
  newest_ns_ = std::max(newest_ns_, end_ns);
  work_off();
}

/// Nothing where the steps kept do not reach back so far.
std::optional<Vector2d> PathHeading::path_at(int64_t t_ns) const {
  if (steps_.empty() || t_ns <= steps_.front().start_ns)
    return steps_.empty() || steps_.size() < kKept ? std::optional<Vector2d>(Vector2d::Zero()) : std::nullopt;
  for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
    if (t_ns < step->start_ns) continue;
    const double part = seconds(t_ns - step->start_ns) / seconds(step->end_ns - step->start_ns);
    return step->from + std::min(1.0, part) * step->by;
  }
  return std::nullopt;
}

void PathHeading::add_position(int64_t t_ns, const Vector2d& position_m, double sigma_m) {
  waiting_.push_back({t_ns, position_m, sigma_m, false});
  work_off();
}

void PathHeading::add_velocity(int64_t t_ns, const Vector2d& velocity_mps, double sigma_mps) {
  waiting_.push_back({t_ns, velocity_mps, sigma_mps, true});
  work_off();
}

void PathHeading::work_off() {
  const int64_t now = waiting_.empty() ? INT64_MIN : std::max(waiting_.back().t_ns, newest_ns_);
  while (!waiting_.empty()) {
    const Seen seen = waiting_.front();
    const bool walked_past = seen.t_ns <= newest_ns_;
    if (!walked_past && now - seen.t_ns < kPatience_ns && waiting_.size() < kKept) return;
    waiting_.pop_front();
    const auto path = path_at(seen.t_ns), before = path_at(seen.t_ns - kVelocity_ns);
    if (path && before) use(seen, *path, (*path - *before) / seconds(kVelocity_ns));
  }
}

void PathHeading::propagate(double dt_s, double walked_m, double sigma_m) {
  const double keep = std::exp(-dt_s / p_.correlation_s), keep_jump = std::exp(-dt_s / p_.bias_s);
  Vector8 F = Vector8::Ones(), Q = Vector8::Zero();
  F.segment<2>(4).setConstant(keep);
  F.tail<2>().setConstant(keep_jump);
  Q.head<2>().setConstant(p_.heading_walk * p_.heading_walk * dt_s);
  Q.segment<2>(2).setConstant(p_.path_walk * p_.path_walk * walked_m);
  Q.segment<2>(4).setConstant(sigma_m * sigma_m * (1 - keep * keep));
  x_ = x_.cwiseProduct(F);
  P_ = F.asDiagonal() * P_ * F.asDiagonal();
  P_.diagonal() += Q;
}

void PathHeading::use(const Seen& seen, const Vector2d& path, const Vector2d& path_velocity) {
  if (seen.is_velocity && !has_position_) return;
  if (!has_position_) {
    has_position_ = true;
    t_ns_ = seen.t_ns, used_path_ = path;
    P_.block<2, 2>(4, 4) = Matrix2d::Identity() * (seen.sigma * seen.sigma);
  }
  if (!seen.is_velocity && seen.t_ns > t_ns_) {
    propagate(seconds(seen.t_ns - t_ns_), (path - used_path_).norm(), seen.sigma);
    t_ns_ = seen.t_ns, used_path_ = path;
  }
  Eigen::Matrix<double, 2, 8> H = Eigen::Matrix<double, 2, 8>::Zero();
  const Vector2d& moved = seen.is_velocity ? path_velocity : path;
  H.leftCols<2>() << moved.x(), -moved.y(), moved.y(), moved.x();
  double noise = p_.white_m * p_.white_m;
  if (seen.is_velocity)  // one a second, alike for longer
    noise = seen.sigma * seen.sigma * std::max(1.0, 2 * p_.velocity_correlation_s) + 0.2 * 0.2;
  else
    for (int k = 2; k < 8; ++k) H(k % 2, k) = 1;
  const Vector2d off = seen.value - H * x_;
  Matrix2d S = H * P_ * H.transpose() + noise * Matrix2d::Identity();
  const double nis = off.dot(S.inverse() * off);
  if (nis > p_.gate_sigma * p_.gate_sigma) {
    if (seen.is_velocity) return;
    P_.bottomRightCorner<2, 2>() += Matrix2d::Identity() * (kJump_m * kJump_m);
    S = H * P_ * H.transpose() + noise * Matrix2d::Identity();
  }
  const Eigen::Matrix<double, 8, 2> K = P_ * H.transpose() * S.inverse();
  x_ += K * off;
  const Matrix8 I_KH = Matrix8::Identity() - K * H;
  P_ = I_KH * P_ * I_KH.transpose() + K * (noise * Matrix2d::Identity()) * K.transpose();
}

std::optional<PathHeading::Turn> PathHeading::turn() const {
  const Vector2d ab = x_.head<2>();
  const double scale = ab.norm();
  if (scale < kLeastScale) return {};
  // Steps know their length: a measurement of the scale, on a copy, because only its direction is linear.
  const Vector2d along = ab / scale, across(-along.y(), along.x());
  const Matrix2d P = P_.topLeftCorner<2, 2>();
  const double s = along.dot(P * along) + p_.scale_sigma * p_.scale_sigma;
  const Vector2d gain = P * along / s;
  const Vector2d better = ab + gain * (1 - scale);
  const Matrix2d left = P - gain * (P * along).transpose();
  if (better.norm() < kLeastScale) return {};
  return Turn{std::atan2(better.y(), better.x()), std::sqrt(std::max(0.0, across.dot(left * across))) / better.norm()};
}

std::optional<PathHeading::Turn> PathHeading::news() {
  const auto now = turn();
  if (!now || now->sigma_rad > kTellable_rad || now->sigma_rad <= 0) return {};
  const double information = 1 / (now->sigma_rad * now->sigma_rad), gained = information - told_information_;
  if (gained < kNews * information) return {};
  const double since = told_information_ > 0 ? wrapped(now->rad - told_rad_) : now->rad;
  const double base = told_information_ > 0 ? told_rad_ : 0.0;
  const Turn news{told_information_ > 0 ? wrapped(base + information / gained * since) : now->rad,
                  1 / std::sqrt(gained)};
  told_information_ = information, told_rad_ = now->rad;
  return news;
}

}  // namespace odograph::gnss
