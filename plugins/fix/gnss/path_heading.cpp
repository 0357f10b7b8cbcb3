// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/gnss/path_heading.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "sdk/math/time.hpp"

namespace odograph::gnss {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

constexpr size_t kKept = 64;  // steps and positions

double wrapped(double rad) { return std::remainder(rad, 2 * std::numbers::pi); }

}  // namespace

PathHeading::PathHeading(const Parameters& parameters) : p_(parameters) {
  x_.setZero();
  P_.setZero();
  P_.diagonal().segment<2>(kYaw).setConstant(p_.initial_sigma * p_.initial_sigma);
  P_.diagonal().segment<2>(kPlace).setConstant(p_.initial_position_sigma_m * p_.initial_position_sigma_m);
  P_.diagonal().segment<2>(kRate).setConstant(p_.heading_rate * p_.heading_rate);
}

void PathHeading::add_step(int64_t start_ns, int64_t end_ns, double length_m, double heading_rad) {
  if (end_ns <= start_ns || !(length_m > 0)) return;
  const Vector2d by = length_m * Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  steps_.push_back({start_ns, end_ns, path_, by});
  path_ += by;
  if (steps_.size() > kKept) steps_.pop_front();
  newest_ns_ = std::max(newest_ns_, end_ns);
  process_waiting();
}

/// Nothing if the stored steps do not reach back that far.
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
  process_waiting();
}

void PathHeading::add_velocity(int64_t t_ns, const Vector2d& velocity_mps, double sigma_mps) {
  waiting_.push_back({t_ns, velocity_mps, sigma_mps, true});
  process_waiting();
}

void PathHeading::process_waiting() {
  const int64_t now = waiting_.empty() ? INT64_MIN : std::max(waiting_.back().t_ns, newest_ns_);
  while (!waiting_.empty()) {
    const Seen seen = waiting_.front();
    const bool walked_past = seen.t_ns <= newest_ns_;
    if (!walked_past && now - seen.t_ns < p_.max_wait_ns && waiting_.size() < kKept) return;
    waiting_.pop_front();
    const auto path = path_at(seen.t_ns), before = path_at(seen.t_ns - p_.velocity_ns);
    if (path && before) use(seen, *path, (*path - *before) / seconds(p_.velocity_ns));
  }
}

void PathHeading::propagate(double dt_s, const Vector2d& moved, double sigma_m) {
  const double decay = std::exp(-dt_s / p_.correlation_s), jump_decay = std::exp(-dt_s / p_.bias_s),
               rate_decay = std::exp(-dt_s / p_.heading_rate_s);
  Matrix F = Matrix::Identity();
  F.block<2, 2>(kPlace, kYaw) << moved.x(), -moved.y(), moved.y(), moved.x();
  F.block<2, 2>(kYaw, kRate) = dt_s * Matrix2d::Identity();
  F.diagonal().segment<2>(kError).setConstant(decay);
  F.diagonal().segment<2>(kJump).setConstant(jump_decay);
  F.diagonal().segment<2>(kRate).setConstant(rate_decay);
  Vector Q = Vector::Zero();
  Q.segment<2>(kYaw).setConstant(p_.heading_walk * p_.heading_walk * dt_s);
  Q.segment<2>(kPlace).setConstant(p_.path_walk * p_.path_walk * moved.norm());
  Q.segment<2>(kError).setConstant(sigma_m * sigma_m * (1 - decay * decay));
  Q.segment<2>(kRate).setConstant(p_.heading_rate * p_.heading_rate * (1 - rate_decay * rate_decay));
  const auto age = [&](Vector& x, Matrix& P) {
    x = F * x;
    P = F * P * F.transpose();
    P.diagonal() += Q;
  };
  age(x_, P_);
  if (has_reported_) age(reported_x_, reported_P_);
}

/// A receiver's velocity is accurate to 0.05 m/s in the open and to 1 m/s with reflections only; its quality persists
/// for minutes. Weighted by the accuracy of the path's own prediction: a worse prediction carries no information about
/// it.
void PathHeading::update_velocity_sigma(double squared_mps2, double by_path_mps2) {
  const double worth = 1 / (1 + std::pow(by_path_mps2 / (p_.max_path_sigma_mps * p_.max_path_sigma_mps), 2));
  velocities_ += worth, velocity_squares_ += worth * (squared_mps2 - by_path_mps2);
}

double PathHeading::velocity_sigma(double reported_mps) const {
  const double squares = p_.velocity_prior_weight * reported_mps * reported_mps + velocity_squares_;
  return std::sqrt(std::max(squares / (p_.velocity_prior_weight + velocities_), std::pow(p_.min_velocity_mps, 2)));
}

void PathHeading::use(const Seen& seen, const Vector2d& path, const Vector2d& path_velocity) {
  if (seen.is_velocity && !has_position_) return;
  if (!has_position_) {
    has_position_ = true;
    t_ns_ = seen.t_ns, used_path_ = path;
    P_.block<2, 2>(kError, kError) = Matrix2d::Identity() * (seen.sigma * seen.sigma);
  }
  if (!seen.is_velocity && seen.t_ns > t_ns_) {
    propagate(seconds(seen.t_ns - t_ns_), path - used_path_, seen.sigma);
    t_ns_ = seen.t_ns, used_path_ = path;
  }
  Eigen::Matrix<double, 2, kStates> H = Eigen::Matrix<double, 2, kStates>::Zero();
  double noise = p_.white_m * p_.white_m;
  if (seen.is_velocity) {  // one per second, with a longer correlation
    H.middleCols<2>(kYaw) << path_velocity.x(), -path_velocity.y(), path_velocity.y(), path_velocity.x();
    noise = std::pow(velocity_sigma(seen.sigma), 2) * std::max(1.0, 2 * p_.velocity_correlation_s) +
            p_.steps_mps * p_.steps_mps;
  } else {
    for (const int from : {kPlace, kError, kJump}) H.middleCols<2>(from).setIdentity();
  }
  const Vector2d off = seen.value - H * x_;
  Matrix2d S = H * P_ * H.transpose() + noise * Matrix2d::Identity();
  const double nis = off.dot(S.inverse() * off);
  if (nis > p_.gate_sigma * p_.gate_sigma) {
    if (seen.is_velocity) return;
    P_.block<2, 2>(kJump, kJump) += Matrix2d::Identity() * (p_.jump_m * p_.jump_m);
    S = H * P_ * H.transpose() + noise * Matrix2d::Identity();
  }
  if (seen.is_velocity) update_velocity_sigma(0.5 * off.squaredNorm(), 0.5 * (H * P_ * H.transpose()).trace());
  const Eigen::Matrix<double, kStates, 2> K = P_ * H.transpose() * S.inverse();
  x_ += K * off;
  const Matrix I_KH = Matrix::Identity() - K * H;
  P_ = I_KH * P_ * I_KH.transpose() + K * (noise * Matrix2d::Identity()) * K.transpose();
}

std::optional<PathHeading::Yaw> PathHeading::yaw() const { return yaw_of(x_, P_); }

std::optional<PathHeading::Yaw> PathHeading::yaw_of(const Vector& x, const Matrix& from) const {
  const Vector2d ab = x.segment<2>(kYaw);
  const double scale = ab.norm();
  if (scale < p_.min_scale) return {};
  // Step lengths measure the scale; applied to a copy, because only the direction is linear.
  const Vector2d along = ab / scale, across(-along.y(), along.x());
  const Matrix2d P = from.block<2, 2>(kYaw, kYaw);
  const double s = along.dot(P * along) + p_.scale_sigma * p_.scale_sigma;
  const Vector2d gain = P * along / s;
  const Vector2d better = ab + gain * (1 - scale);
  const Matrix2d left = P - gain * (P * along).transpose();
  if (better.norm() < p_.min_scale) return {};
  return Yaw{std::atan2(better.y(), better.x()), std::sqrt(std::max(0.0, across.dot(left * across))) / better.norm()};
}

std::optional<PathHeading::Yaw> PathHeading::new_information() {
  const auto now = yaw();
  if (!now || now->sigma_rad > p_.max_yaw_sigma_rad || now->sigma_rad <= 0) return {};
  const double information = 1 / (now->sigma_rad * now->sigma_rad);
  Yaw independent = *now;
  const auto reported = has_reported_ ? yaw_of(reported_x_, reported_P_) : std::nullopt;
  if (reported) {
    const double gained = information - 1 / (reported->sigma_rad * reported->sigma_rad);
    if (gained < p_.min_gain * information) return {};
    independent = {wrapped(reported->rad + information / gained * wrapped(now->rad - reported->rad)),
                   1 / std::sqrt(gained)};
  }
  has_reported_ = true, reported_x_ = x_, reported_P_ = P_;
  return independent;
}

}  // namespace odograph::gnss
