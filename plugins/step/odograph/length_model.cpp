// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/length_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "sdk/math/scalar.hpp"

namespace odograph::steps {

using Eigen::Vector2d;

namespace {

constexpr double kFormat = 2;  ///< of the saved walker

}  // namespace

double LengthModel::pace(const FoundStep& step) const {
  return std::log(std::max(step.frequency_hz, p_.min_cadence_hz) / p_.slow_hz);
}

LengthModel::Terms LengthModel::terms(const FoundStep& step) const {
  const bool of_trunk =
      !step.gentle && step.vertical_part > p_.min_vertical_part && step.frequency_hz > p_.min_harmonic_hz;
  return {p_.by_rise * std::log(std::max(step.rise_m, 1e-3) / p_.usual_rise_m), -p_.per_turning_s * step.turning_radps,
          of_trunk ? -p_.per_harmonic * step.second_harmonic : 0.0, step.on_leg ? p_.on_leg : 0.0,
          p_.by_own_cadence * std::max(pace(step), 0.0)};
}

double LengthModel::length_m(const FoundStep& step) const {
  const double of_usual = terms(step).cwiseMax(p_.least).cwiseMin(p_.most).sum();
  const double length = p_.usual_m * std::exp(p_.by_cadence * std::min(pace(step), 0.0) + of_usual);
  return std::clamp(initiation_part(step) * length, p_.shortest_m, p_.longest_m);
}

double LengthModel::initiation_part(const FoundStep& step) const {
  return 1 - (1 - p_.first_part) * std::exp(-step.since_stood / p_.initiation_steps);
}

double LengthModel::own_sigma(const FoundStep& step) const {
  const double part = initiation_part(step);
  return std::hypot(p_.step_sigma + p_.per_irregularity * std::clamp(1 - step.repetition, 0.0, 0.5),
                    p_.initiation_sigma * (1 - part) / part);
}

double LengthModel::common_sigma(const FoundStep& step) const {
  return p_.terms_sigma * (terms(step) - p_.fitted).norm();
}

ModelLength LengthModel::estimate(const FoundStep& step) const {
  return {length_m(step), pace(step), own_sigma(step), common_sigma(step), step.gentle};
}

double Walker::relative(double pace) const {
  const double known = 1 - std::min(walker_(0, 0) / squared(p_.factor_sigma), 1.0);
  return std::exp(slope_ * std::min(pace, 0.0) + known * p_.by_own_cadence * (std::max(pace, 0.0) - usual_quickness_));
}

double Walker::factor_sigma(double pace) const {
  const double slowness = std::min(pace, 0.0), relative = 1 / factor_;  // the slope's is relative already
  return std::sqrt(std::max(0.0, squared(relative) * walker_(0, 0) + squared(slowness) * walker_(1, 1) +
                                     2 * relative * slowness * walker_(0, 1)));
}

void Walker::on_step(const ModelLength& length, double heading_rad) {
  const double length_m = length.m * relative(length.pace);
  const Vector2d step = length_m * Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  path_ += step, by_slope_ += std::min(length.pace, 0.0) * step;
  walked_m_ += length_m;
  quick_walked_m_ += length_m, quickness_m_ += std::max(length.pace, 0.0) * length_m;
  if (length.gentle) gentle_m_ += length_m;
  own_variance_m2_ += squared(length_m * length.own_sigma);
  common_sigma_m_ += length_m * length.common_sigma;
}

void Walker::start_at(const Vector2d& p_n, double sigma_m) {
  x_ << 0, 0, slope_, p_n;
  P_.setZero();
  P_.diagonal() << Vector2d::Constant(p_.any_rotation), walker_(1, 1), Vector2d::Constant(squared(sigma_m));
  is_placed_ = true, is_rotated_ = false;
  rejected_ = 0;
  start_path();
}

void Walker::start_path() {
  path_.setZero(), by_slope_.setZero();
  walked_m_ = gentle_m_ = own_variance_m2_ = common_sigma_m_ = 0;
}

/// State and covariance at the end of the path, which the fix shows to be `seen_m`.
void Walker::predict(State& x, Covariance& P, const Vector2d& seen_m, double common_m) const {
  const Vector2d path = path_ + (x[2] - slope_) * by_slope_;
  Eigen::Matrix2d turned;  // (path, path turned by a right angle): the displacement is linear in the state
  turned << path.x(), -path.y(), path.y(), path.x();
  // About which it is linearised by the slope.
  Vector2d at = x.head<2>();
  if (!is_rotated_) at = factor_ * (turned.transpose() * seen_m).stableNormalized();
  const Vector2d turning(-at.y(), at.x()), along = (turned * at).stableNormalized(), across(-along.y(), along.x());
  Covariance F = Covariance::Identity();
  F.block<2, 2>(3, 0) = turned;
  F.block<2, 1>(3, 2) = by_slope_.x() * at + by_slope_.y() * turning;
  x.tail<2>() += turned * x.head<2>();
  P.topLeftCorner<2, 2>() += squared(p_.rotation_drift_rad) * walked_m_ * turning * turning.transpose();
  P = F * P * F.transpose();
  const double common_m2 = squared(common_sigma_m_) * std::max(1.0, common_m / std::max(walked_m_, 0.1));
  const double hand_m2 = squared(p_.gentle_hand_rad) * p_.gentle_hand_m * gentle_m_;
  P.bottomRightCorner<2, 2>() += own_variance_m2_ * Eigen::Matrix2d::Identity() +
                                 common_m2 * along * along.transpose() + hand_m2 * across * across.transpose();
}

void Walker::on_fix(const Vector2d& p_n, double sigma_m, bool accumulates) {
  if (!is_placed_) return start_at(p_n, sigma_m);
  if (!accumulates && walked_m_ < p_.min_walked_m) return;
  if (accumulates && path_.norm() < std::max(p_.min_path_m, p_.fix_sigmas * std::sqrt(2.0) * sigma_m)) return;
  State x = x_;
  Covariance P = P_;
  predict(x, P, p_n - x.tail<2>(), accumulates ? 0 : p_.common_m);
  const Eigen::Matrix2d S = P.bottomRightCorner<2, 2>() + squared(sigma_m) * Eigen::Matrix2d::Identity();
  const Vector2d innovation = p_n - x.tail<2>();
  const Eigen::Matrix2d inverse = S.inverse();
  if (innovation.dot(inverse * innovation) > p_.gate) {
    // Either this fix or the path is wrong: restarts from here after some more rejections.
    if (++rejected_ >= p_.max_rejected) start_at(p_n, sigma_m);
    return;
  }
  const Eigen::Matrix<double, 5, 2> K = P.rightCols<2>() * inverse;
  x_ = x + K * innovation;
  P_ = P - K * S * K.transpose();
  rejected_ = 0;
  start_path();
  learn();
  if (!accumulates) return;
  x_.tail<2>() = p_n;
  P_.rightCols<2>().setZero(), P_.bottomRows<2>().setZero();
  P_.bottomRightCorner<2, 2>() = squared(sigma_m) * Eigen::Matrix2d::Identity();
}

/// Factor and slope from the state, once the rotation is known.
void Walker::learn() {
  const double size = x_.head<2>().norm();
  Eigen::Matrix<double, 5, 1> u = Eigen::Matrix<double, 5, 1>::Zero();
  if (!(size > 0)) return;
  u.head<2>() = x_.head<2>() / size;
  if (!is_rotated_) {
    const Vector2d across(-u[1], u[0]);
    if (across.dot(P_.topLeftCorner<2, 2>() * across) > squared(p_.known_rotation_rad * size)) return;
    const Eigen::Matrix<double, 5, 1> K = P_ * u / (u.dot(P_ * u) + walker_(0, 0));
    x_ += K * (factor_ - size);
    P_ -= K * u.transpose() * P_;
    is_rotated_ = true;
  }
  const double before = walker_(0, 0);
  const double seen = x_.head<2>().norm();
  factor_ = std::clamp(seen, p_.min_factor, p_.max_factor);
  if (seen > 0) x_.head<2>() *= factor_ / seen;
  slope_ = x_[2] = std::clamp(x_[2], -p_.max_slope, p_.max_slope);
  const double cross = u.dot(P_.col(2));
  P_ += std::max(0.0, squared(p_.min_factor_sigma) - u.dot(P_ * u)) * u * u.transpose();
  P_(2, 2) = std::max(P_(2, 2), squared(p_.min_slope_sigma));
  walker_ << u.dot(P_ * u), cross, cross, P_(2, 2);
  if (quick_walked_m_ > 0)
    usual_quickness_ += std::max(0.0, 1 - walker_(0, 0) / before) * (quickness_m_ / quick_walked_m_ - usual_quickness_);
  quickness_m_ = quick_walked_m_ = 0;
}

std::vector<uint8_t> Walker::save() const {
  const double numbers[6] = {kFormat, factor_, walker_(0, 0), slope_, walker_(1, 1), usual_quickness_};
  std::vector<uint8_t> bytes(sizeof numbers);
  std::memcpy(bytes.data(), numbers, sizeof numbers);
  return bytes;
}

bool Walker::load(const uint8_t* data, size_t size) {
  double numbers[6] = {};
  // Factors on an earlier version's lengths are of no use here.
  if (size == 2 * sizeof numbers[0] || size == 4 * sizeof numbers[0]) return true;
  if (size != sizeof numbers) return false;
  std::memcpy(numbers, data, size);
  const auto [format, factor, factor_variance, slope, slope_variance, quickness] = numbers;
  if (format != kFormat || !(factor > 0.4 && factor < 2) || !(std::abs(slope) <= p_.max_slope)) return false;
  if (!(factor_variance > 0 && factor_variance < 1 && slope_variance > 0 && slope_variance < 1)) return false;
  if (!(quickness >= 0 && quickness < 1)) return false;
  factor_ = factor, slope_ = slope, usual_quickness_ = quickness;
  quickness_m_ = quick_walked_m_ = 0;
  walker_ << std::max(factor_variance, p_.loaded_factor_variance), 0, 0,
      std::max(slope_variance, p_.loaded_slope_variance);
  is_placed_ = false;
  return true;
}

}  // namespace odograph::steps
