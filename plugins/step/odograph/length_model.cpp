// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/length_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace odograph::steps {

using Eigen::Vector2d;

namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kShortest_m = 0.15, kLongest_m = 1.6;
constexpr double kLeastRise_m = 0.001;
constexpr double kCalmest_radps = 0.2, kWildest_radps = 1.4;  // beyond, nobody has been measured
constexpr double kGate = 9.0;                                 // squared, of two components: 1 % of good ways
constexpr double kLeastFactor = 0.008, kLeastGentle = 0.05;   // standard deviations: a walker is not the same all day
constexpr int kBelieveAfter = 3;  // ways in a row that contradict what is known, but not each other's anchor

}  // namespace

double LengthModel::length_m(const FoundStep& step) const {
  if (step.gentle) {
    const double by_cadence = std::pow(at_one_mps_m * std::pow(step.frequency_hz, by_speed), 1 / (1 - by_speed));
    const double by_rise = per_root_gentle_rise * std::sqrt(std::max(kLeastRise_m, step.whole_rise_m));
    const double length = std::pow(by_cadence, 1 - part_of_rise) * std::pow(by_rise, part_of_rise);
    return std::clamp(gentle_factor * length, kShortest_m, kLongest_m);
  }
  const double rate = std::clamp(step.gyro_radps, kCalmest_radps, kWildest_radps);
  const double root = std::sqrt(std::max(0.0, step.rise_m));
  return std::clamp(base_m + (per_root_rise + per_rate_and_root * rate) * root, kShortest_m, kLongest_m);
}

double Walker::factor_sigma() const { return std::sqrt(P_(0, 0)); }

double Walker::sigma_m(double length_m, bool gentle) const {
  const double step = gentle ? p_.gentle_step_sigma : p_.step_sigma;
  const double walker = gentle ? P_(0, 0) + P_(1, 1) + 2 * P_(0, 1) : P_(0, 0);
  return length_m * std::sqrt(walker + step * step);
}

void Walker::on_step(double length_m, double heading_rad, bool gentle) {
  (gentle ? gentle_way_ : way_) += length_m * Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  walked_m_ += length_m;
  const double own = gentle ? p_.gentle_step_sigma : p_.step_sigma;
  own_variance_m2_ += length_m * length_m * own * own;
  if (gentle) gentle_m_ += length_m;
}

void Walker::on_fix(const Vector2d& p_n, double sigma_m) {
  const auto anchor_here = [&] {
    has_anchor_ = true;
    anchor_ = p_n, anchor_sigma_m_ = sigma_m;
    way_.setZero(), gentle_way_.setZero();
    walked_m_ = gentle_m_ = own_variance_m2_ = 0;
    doubted_ = 0;
  };
  if (!has_anchor_) return anchor_here();
  const double fix_sigma = std::hypot(sigma_m, anchor_sigma_m_);
  const Vector2d way = way_ + gentle_ratio_ * gentle_way_;
  // A way teaches when the fixes' own errors do not drown it.
  if (way.norm() < std::max(p_.least_way_m, 3 * fix_sigma)) return;
  const Vector2d seen = p_n - anchor_;
  const double hand_m2 = p_.gentle_hand_rad * p_.gentle_hand_rad * p_.gentle_hand_m * gentle_m_;  // across the way
  if (!has_turn_) {
    // The first way tells the turn; its length the factor.
    turn_rad_ = std::remainder(std::atan2(seen.y(), seen.x()) - std::atan2(way.y(), way.x()), kTwoPi);
    P_.row(2).setZero(), P_.col(2).setZero();
    P_(2, 2) = (fix_sigma * fix_sigma + hand_m2) / way.squaredNorm();
    has_turn_ = true;
  } else {
    P_(2, 2) += p_.turn_drift_rad * p_.turn_drift_rad * walked_m_;
  }
  const Eigen::Rotation2Dd turn(turn_rad_);
  const Vector2d turned = turn * way, across = Vector2d(-turned.y(), turned.x());
  Eigen::Matrix<double, 2, 3> H;
  H.col(0) = turned;                          // by the factor
  H.col(1) = factor_ * (turn * gentle_way_);  // by the gentle steps' own
  H.col(2) = factor_ * across;                // by the turn
  const Eigen::Matrix2d own = (fix_sigma * fix_sigma + own_variance_m2_) * Eigen::Matrix2d::Identity() +
                              hand_m2 / way.squaredNorm() * across * across.transpose();
  const Eigen::Matrix2d S = H * P_ * H.transpose() + own;
  const Vector2d innovation = seen - factor_ * turned;
  const Eigen::Matrix2d inverse = S.inverse();
  if (innovation.dot(inverse * innovation) > kGate) {
    // Either this fix is wrong or the anchor was: the way stays open, and after some more begins anew from here.
    if (++doubted_ >= kBelieveAfter) anchor_here(), has_turn_ = false;
    return;
  }
  const Eigen::Matrix<double, 3, 2> K = P_ * H.transpose() * inverse;
  const Eigen::Vector3d correction = K * innovation;
  factor_ = std::clamp(factor_ + correction[0], 0.6, 1.6);
  gentle_ratio_ = std::clamp(gentle_ratio_ + correction[1], 0.5, 1.6);
  turn_rad_ = std::remainder(turn_rad_ + correction[2], kTwoPi);
  P_ = (Eigen::Matrix3d::Identity() - K * H) * P_;
  P_ = 0.5 * (P_ + P_.transpose()).eval();
  const Eigen::Vector3d least(kLeastFactor * kLeastFactor, kLeastGentle * kLeastGentle, 1e-6);
  P_.diagonal() = P_.diagonal().cwiseMax(least).eval();
  anchor_here();
}

std::vector<uint8_t> Walker::save() const {
  const double numbers[4] = {factor_, P_(0, 0), gentle_ratio_, P_(1, 1)};
  std::vector<uint8_t> bytes(sizeof numbers);
  std::memcpy(bytes.data(), numbers, sizeof numbers);
  return bytes;
}

bool Walker::load(const uint8_t* data, size_t size) {
  double numbers[4] = {1, 1, gentle_ratio_, P_(1, 1)};
  if (size != sizeof numbers && size != 2 * sizeof numbers[0]) return false;  // the latter: without gentle steps
  std::memcpy(numbers, data, size);
  for (const int k : {0, 2})
    if (!(numbers[k] > 0.4 && numbers[k] < 2 && numbers[k + 1] > 0 && numbers[k + 1] < 1)) return false;
  factor_ = numbers[0], gentle_ratio_ = numbers[2];
  P_.setZero();
  P_(0, 0) = std::max(numbers[1], 4e-4);  // another day, other shoes
  P_(1, 1) = std::max(numbers[3], 0.01);  // and another hurry
  has_turn_ = false;
  return true;
}

}  // namespace odograph::steps
