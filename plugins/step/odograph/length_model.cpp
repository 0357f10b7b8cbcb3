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

}  // namespace

double LengthModel::length_m(const FoundStep& step) const {
  if (step.gentle) {
    const double by_cadence = std::pow(at_one_mps_m * std::pow(step.frequency_hz, by_speed), 1 / (1 - by_speed));
    const double by_rise = per_root_gentle_rise * std::sqrt(std::max(min_rise_m, step.whole_rise_m));
    const double length = std::pow(by_cadence, 1 - part_of_rise) * std::pow(by_rise, part_of_rise);
    return std::clamp(gentle_factor * length, shortest_m, longest_m);
  }
  const double quicker_hz = std::clamp(step.frequency_hz, min_cadence_hz, max_cadence_hz) - usual_cadence_hz;
  const double higher_m = std::min(step.rise_m, max_rise_m) - usual_rise_m;
  const double rocking =
      (std::clamp(step.gyro_radps, min_rate_radps, max_rate_radps) - usual_radps) * (step.vertical_part - usual_part);
  const double length =
      usual_m + per_rise * (step.rise_m - usual_rise_m) + per_cadence_and_rise * quicker_hz * higher_m +
      per_repetition * (step.repetition - usual_repetition) + per_rocking_and_rise * rocking * step.rise_m;
  return std::clamp(initiation_part(step) * length, shortest_m, longest_m);
}

double LengthModel::initiation_part(const FoundStep& step) const {
  return 1 - (1 - first_part) * std::exp(-step.since_stood / initiation_steps);
}

double LengthModel::own_sigma(const FoundStep& step) const {
  if (step.gentle) return gentle_sigma;
  const double part = initiation_part(step);
  return std::hypot(regular_sigma + per_irregularity * std::clamp(1 - step.repetition, 0.0, 0.5),
                    initiation_sigma * (1 - part) / part);
}

double Walker::factor_sigma() const { return std::sqrt(P_(0, 0)); }

double Walker::sigma_m(double length_m, double own_sigma, bool gentle) const {
  const double walker = gentle ? P_(0, 0) + P_(1, 1) + 2 * P_(0, 1) : P_(0, 0);
  return length_m * std::sqrt(walker + own_sigma * own_sigma);
}

void Walker::on_step(double length_m, double heading_rad, double own_sigma, bool gentle) {
  (gentle ? gentle_path_ : path_) += length_m * Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  walked_m_ += length_m;
  own_variance_m2_ += length_m * length_m * own_sigma * own_sigma;
  if (gentle) gentle_m_ += length_m;
}

void Walker::on_fix(const Vector2d& p_n, double sigma_m) {
  const auto anchor_here = [&] {
    has_anchor_ = true;
    anchor_ = p_n, anchor_sigma_m_ = sigma_m;
    path_.setZero(), gentle_path_.setZero();
    walked_m_ = gentle_m_ = own_variance_m2_ = 0;
    rejected_ = 0;
  };
  if (!has_anchor_) return anchor_here();
  const double fix_sigma = std::hypot(sigma_m, anchor_sigma_m_);
  const Vector2d path = path_ + gentle_ratio_ * gentle_path_;
  // A path is informative if it exceeds the errors of the fixes.
  if (path.norm() < std::max(p_.min_path_m, p_.fix_sigmas * fix_sigma)) return;
  const Vector2d seen = p_n - anchor_;
  const double hand_m2 = p_.gentle_hand_rad * p_.gentle_hand_rad * p_.gentle_hand_m * gentle_m_;  // across the path
  if (!has_rotation_) {
    // The first path gives the rotation; its length gives the factor.
    rotation_rad_ = std::remainder(std::atan2(seen.y(), seen.x()) - std::atan2(path.y(), path.x()), kTwoPi);
    P_.row(2).setZero(), P_.col(2).setZero();
    P_(2, 2) = (fix_sigma * fix_sigma + hand_m2) / path.squaredNorm();
    has_rotation_ = true;
  } else {
    P_(2, 2) += p_.rotation_drift_rad * p_.rotation_drift_rad * walked_m_;
  }
  const Eigen::Rotation2Dd rotation(rotation_rad_);
  const Vector2d rotated = rotation * path, across = Vector2d(-rotated.y(), rotated.x());
  Eigen::Matrix<double, 2, 3> H;
  H.col(0) = rotated;                              // derivative by the factor
  H.col(1) = factor_ * (rotation * gentle_path_);  // by the gentle ratio
  H.col(2) = factor_ * across;                     // by the rotation
  const Eigen::Matrix2d own = (fix_sigma * fix_sigma + own_variance_m2_) * Eigen::Matrix2d::Identity() +
                              hand_m2 / path.squaredNorm() * across * across.transpose();
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
  gentle_ratio_ = std::clamp(gentle_ratio_ + correction[1], p_.min_gentle_ratio, p_.max_gentle_ratio);
  rotation_rad_ = std::remainder(rotation_rad_ + correction[2], kTwoPi);
  P_ = (Eigen::Matrix3d::Identity() - K * H) * P_;
  P_ = 0.5 * (P_ + P_.transpose()).eval();
  const Eigen::Vector3d least(p_.min_factor_sigma, p_.min_gentle_sigma, p_.min_rotation_sigma_rad);
  P_.diagonal() = P_.diagonal().cwiseMax(least.cwiseAbs2()).eval();
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
  P_(0, 0) = std::max(numbers[1], p_.loaded_factor_variance);
  P_(1, 1) = std::max(numbers[3], p_.loaded_gentle_variance);
  has_rotation_ = false;
  return true;
}

}  // namespace odograph::steps
