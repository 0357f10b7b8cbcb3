// SPDX-License-Identifier: Apache-2.0
#include "plugins/step/odograph/length_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace odograph::steps {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kShortest_m = 0.15, kLongest_m = 1.6;
constexpr double kLeastRise_m = 0.001;
constexpr double kCalmest_radps = 0.2, kWildest_radps = 1.4;  // beyond, nobody has been measured
constexpr double kGate = 9.0;                                 // squared, of two components: 1 % of good ways
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

double Walker::factor_sigma() const { return std::sqrt(variance_); }

double Walker::sigma_m(double length_m, bool gentle) const {
  const double own = gentle ? std::hypot(p_.gentle_step_sigma, p_.gentle_factor_sigma) : p_.step_sigma;
  return length_m * std::sqrt(variance_ + own * own);
}

void Walker::on_step(double length_m, double heading_rad, bool gentle) {
  way_ += length_m * Eigen::Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  walked_m_ += length_m;
  const double own = gentle ? p_.gentle_step_sigma : p_.step_sigma;
  own_variance_m2_ += length_m * length_m * own * own;
  if (gentle) gentle_m_ += length_m;
}

void Walker::on_fix(const Eigen::Vector2d& p_n, double sigma_m) {
  const auto anchor_here = [&] {
    has_anchor_ = true;
    anchor_ = p_n, anchor_sigma_m_ = sigma_m;
    way_.setZero();
    walked_m_ = gentle_m_ = own_variance_m2_ = 0;
    doubted_ = 0;
  };
  if (!has_anchor_) return anchor_here();
  const double fix_sigma = std::hypot(sigma_m, anchor_sigma_m_);
  // A way teaches when the fixes' own errors do not drown it.
  if (way_.norm() < std::max(p_.least_way_m, 3 * fix_sigma)) return;
  const Eigen::Vector2d seen = p_n - anchor_;
  if (!has_turn_) {
    // The first way tells the turn; its length the factor.
    turn_rad_ = std::remainder(std::atan2(seen.y(), seen.x()) - std::atan2(way_.y(), way_.x()), kTwoPi);
    turn_variance_ = std::pow(fix_sigma / way_.norm(), 2);
    has_turn_ = true;
  } else {
    turn_variance_ += p_.turn_drift_rad * p_.turn_drift_rad * walked_m_;
  }
  const Eigen::Vector2d turned = Eigen::Rotation2Dd(turn_rad_) * way_, expected = factor_ * turned;
  Eigen::Matrix2d H;
  H.col(0) = turned;                                              // by the factor
  H.col(1) = factor_ * Eigen::Vector2d(-turned.y(), turned.x());  // by the turn
  const Eigen::Matrix2d P = Eigen::Vector2d(variance_, turn_variance_).asDiagonal();
  const double own = fix_sigma * fix_sigma + own_variance_m2_ + std::pow(p_.gentle_factor_sigma * gentle_m_, 2);
  const Eigen::Matrix2d S = H * P * H.transpose() + Eigen::Matrix2d::Identity() * own;
  const Eigen::Vector2d innovation = seen - expected;
  const Eigen::Matrix2d inverse = S.inverse();
  if (innovation.dot(inverse * innovation) > kGate) {
    // Either this fix is wrong or the anchor was: the way stays open, and after some more begins anew from here.
    if (++doubted_ >= kBelieveAfter) anchor_here(), has_turn_ = false;
    return;
  }
  const Eigen::Matrix2d K = P * H.transpose() * inverse;
  const Eigen::Vector2d correction = K * innovation;
  factor_ = std::clamp(factor_ + correction[0], 0.6, 1.6);
  turn_rad_ = std::remainder(turn_rad_ + correction[1], kTwoPi);
  const Eigen::Matrix2d left = (Eigen::Matrix2d::Identity() - K * H) * P;
  constexpr double kLeast = 0.008;  // a walker is not the same all day
  variance_ = std::max(left(0, 0), kLeast * kLeast);
  turn_variance_ = std::max(left(1, 1), 1e-6);
  anchor_here();
}

std::vector<uint8_t> Walker::save() const {
  const double numbers[2] = {factor_, variance_};
  std::vector<uint8_t> bytes(sizeof numbers);
  std::memcpy(bytes.data(), numbers, sizeof numbers);
  return bytes;
}

bool Walker::load(const uint8_t* data, size_t size) {
  double numbers[2];
  if (size != sizeof numbers) return false;
  std::memcpy(numbers, data, sizeof numbers);
  if (!(numbers[0] > 0.5 && numbers[0] < 2 && numbers[1] > 0 && numbers[1] < 1)) return false;
  factor_ = numbers[0];
  variance_ = std::max(numbers[1], 4e-4);  // another day, other shoes
  return true;
}

}  // namespace odograph::steps
