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

constexpr double kTwoPi = 6.283185307179586;
constexpr double kFormat = 2;  ///< of the saved walker

}  // namespace

double LengthModel::relative_rise(const FoundStep& step) const {
  return std::log(std::clamp(step.rise_m, p_.min_rise_m, p_.max_rise_m) / p_.usual_rise_m);
}

double LengthModel::pace(const FoundStep& step) const {
  return std::log(std::max(step.frequency_hz, p_.min_cadence_hz) / p_.slow_hz);
}

double LengthModel::length_m(const FoundStep& step) const {
  const bool of_trunk =
      !step.gentle && step.vertical_part > p_.min_vertical_part && step.frequency_hz > p_.min_harmonic_hz;
  const double harmonic = of_trunk ? std::clamp(step.second_harmonic, 0.0, p_.max_harmonic) : 0.0;
  const double of_usual = p_.by_cadence * std::min(pace(step), 0.0) + p_.by_rise * relative_rise(step) -
                          p_.per_turning_s * std::min(step.turning_radps, p_.max_turning_radps) -
                          p_.per_harmonic * harmonic;
  const double length = p_.usual_m * std::exp(of_usual) * (step.on_leg ? p_.leg_factor : 1.0);
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
  const double by_rise = p_.by_rise_sigma * relative_rise(step);
  const double by_pace = p_.by_fast_sigma * std::max(0.0, std::log(step.frequency_hz / p_.fast_hz));
  const double by_place = std::hypot(step.on_leg ? p_.leg_sigma : 0.0, step.gentle ? p_.gentle_sigma : 0.0);
  return std::hypot(by_rise, by_pace, by_place);
}

ModelLength LengthModel::estimate(const FoundStep& step) const {
  return {length_m(step), pace(step), own_sigma(step), common_sigma(step), step.gentle};
}

double Walker::relative(double pace) const {
  const double known = 1 - std::min(P_(0, 0) / squared(p_.factor_sigma), 1.0);
  return std::exp(slope_ * std::min(pace, 0.0) + known * p_.by_own_cadence * (std::max(pace, 0.0) - usual_quickness_));
}

double Walker::factor_sigma(double pace) const {
  const double slowness = std::min(pace, 0.0), relative = 1 / factor_;  // the slope's is relative already
  return std::sqrt(
      std::max(0.0, squared(relative) * P_(0, 0) + squared(slowness) * P_(1, 1) + 2 * relative * slowness * P_(0, 1)));
}

void Walker::on_step(const ModelLength& length, double heading_rad) {
  const double length_m = length.m * relative(length.pace);
  const Vector2d step = length_m * Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  path_ += step, by_slope_ += std::min(length.pace, 0.0) * step;
  walked_m_ += length_m, quickness_m_ += std::max(length.pace, 0.0) * length_m;
  if (length.gentle) gentle_m_ += length_m;
  own_variance_m2_ += squared(length_m * length.own_sigma);
  common_sigma_m_ += length_m * length.common_sigma;
}

void Walker::on_fix(const Vector2d& p_n, double sigma_m) {
  const auto anchor_here = [&] {
    has_anchor_ = true;
    anchor_ = p_n, anchor_sigma_m_ = sigma_m;
    path_.setZero(), by_slope_.setZero();
    walked_m_ = gentle_m_ = own_variance_m2_ = common_sigma_m_ = quickness_m_ = 0;
    rejected_ = 0;
  };
  if (!has_anchor_) return anchor_here();
  const double fix_sigma = std::hypot(sigma_m, anchor_sigma_m_);
  // A path is informative if it exceeds the errors of the fixes.
  if (path_.norm() < std::max(p_.min_path_m, p_.fix_sigmas * fix_sigma)) return;
  const Vector2d seen = p_n - anchor_;
  const double hand_m2 = squared(p_.gentle_hand_rad) * p_.gentle_hand_m * gentle_m_;  // across the path
  if (!has_rotation_) {
    // The first path gives the rotation; its length gives the factor.
    rotation_rad_ = std::remainder(std::atan2(seen.y(), seen.x()) - std::atan2(path_.y(), path_.x()), kTwoPi);
    P_.row(2).setZero(), P_.col(2).setZero();
    P_(2, 2) = (fix_sigma * fix_sigma + hand_m2) / path_.squaredNorm();
    has_rotation_ = true;
  } else {
    P_(2, 2) += p_.rotation_drift_rad * p_.rotation_drift_rad * walked_m_;
  }
  const Eigen::Rotation2Dd rotation(rotation_rad_);
  const Vector2d rotated = rotation * path_, across = Vector2d(-rotated.y(), rotated.x());
  Eigen::Matrix<double, 2, 3> H;
  H.col(0) = rotated;                           // derivative by the factor
  H.col(1) = factor_ * (rotation * by_slope_);  // by the slope
  H.col(2) = factor_ * across;                  // by the rotation
  const Eigen::Matrix2d own = (fix_sigma * fix_sigma + own_variance_m2_) * Eigen::Matrix2d::Identity() +
                              squared(common_sigma_m_ / walked_m_) * rotated * rotated.transpose() +
                              hand_m2 / path_.squaredNorm() * across * across.transpose();
  const Eigen::Matrix2d S = H * P_ * H.transpose() + own;
  const Vector2d innovation = seen - factor_ * rotated;
  const Eigen::Matrix2d inverse = S.inverse();
  if (innovation.dot(inverse * innovation) > p_.gate) {
    // Either this fix or the anchor is wrong: keeps the path, and restarts from here after some more rejections.
    if (++rejected_ >= p_.max_rejected) anchor_here(), has_rotation_ = false;
    return;
  }
  const Eigen::Matrix<double, 3, 2> K = P_ * H.transpose() * inverse;
  const Eigen::Vector3d correction = K * innovation;
  factor_ = std::clamp(factor_ + correction[0], p_.min_factor, p_.max_factor);
  slope_ = std::clamp(slope_ + correction[1], -p_.max_slope, p_.max_slope);
  rotation_rad_ = std::remainder(rotation_rad_ + correction[2], kTwoPi);
  const double before = P_(0, 0);
  P_ = (Eigen::Matrix3d::Identity() - K * H) * P_;
  usual_quickness_ += (1 - P_(0, 0) / before) * (quickness_m_ / walked_m_ - usual_quickness_);
  P_ = 0.5 * (P_ + P_.transpose()).eval();
  const Eigen::Vector3d least(p_.min_factor_sigma, p_.min_slope_sigma, p_.min_rotation_sigma_rad);
  P_.diagonal() = P_.diagonal().cwiseMax(least.cwiseAbs2()).eval();
  anchor_here();
}

std::vector<uint8_t> Walker::save() const {
  const double numbers[6] = {kFormat, factor_, P_(0, 0), slope_, P_(1, 1), usual_quickness_};
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
  P_.setZero();
  P_(0, 0) = std::max(factor_variance, p_.loaded_factor_variance);
  P_(1, 1) = std::max(slope_variance, p_.loaded_slope_variance);
  has_rotation_ = false;
  return true;
}

}  // namespace odograph::steps
