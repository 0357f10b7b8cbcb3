// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/photograph_prior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace odograph::skyline {
namespace {

constexpr double kAnyHeading = 1.5;  // rad; with a larger standard deviation any heading is as likely; judgement

}  // namespace

PhotographPrior::Vector6 PhotographPrior::sigmas() const {
  Vector6 s;
  s << sigma_m, sigma_m, yaw_sigma_rad, tilt_sigma_rad, tilt_sigma_rad, height_sigma_m;
  return s;
}

/// The likelihood that the compass is right with this error, over that of no error, and that it is wrong by any angle.
std::array<double, 2> PhotographPrior::heading_likelihoods(double yaw) const {
  const double x = yaw / yaw_sigma_rad;
  if (yaw_sigma_rad > kAnyHeading) return {0, 1};
  return {std::exp(-0.5 * x * x),
          wrong_heading / (1 - wrong_heading) * yaw_sigma_rad / std::sqrt(2 * std::numbers::pi)};
}

PhotographPrior::Vector6 PhotographPrior::information(const Guess& guess) const {
  Vector6 information = sigmas().cwiseAbs2().cwiseInverse();
  const auto [right, wrong] = heading_likelihoods(guess.yaw);
  information[2] = (right * information[2] + wrong / (kAnyHeading * kAnyHeading)) / (right + wrong);
  return information;
}

double PhotographPrior::cost(const Guess& guess) const {
  const double far = std::hypot(guess.north, guess.east) / sigma_m, up = guess.up / height_sigma_m;
  const double tilt = std::hypot(guess.tilt_north, guess.tilt_east) / tilt_sigma_rad;
  const auto [right, wrong] = heading_likelihoods(guess.yaw);
  return 0.5 * (far * far + tilt * tilt + up * up) - std::log(right + wrong);
}

double PhotographPrior::log_volume() const {
  Vector6 s = sigmas();
  s[2] = std::min(s[2], kAnyHeading);
  return s.array().log().sum();
}

Eigen::Matrix2d covariance_without_prior(const Eigen::Matrix2d& covariance, double prior_sigma_m, double min_sigma_m,
                                         double unobserved_sigma_m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  const double min = min_sigma_m * min_sigma_m, most = unobserved_sigma_m * unobserved_sigma_m;
  const Eigen::Array2d known = (axes.eigenvalues().array() - min).max(1e-6);
  const Eigen::Array2d measured = (known.inverse() - 1 / (prior_sigma_m * prior_sigma_m)).max(1 / most).inverse();
  const Eigen::Vector2d variances = measured + min;
  return axes.eigenvectors() * variances.asDiagonal() * axes.eigenvectors().transpose();
}

}  // namespace odograph::skyline
