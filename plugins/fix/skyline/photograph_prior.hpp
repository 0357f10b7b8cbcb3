// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/match_parameters.hpp"
#include "plugins/fix/skyline/seen_skyline.hpp"

namespace odograph::skyline {

/// What is known of a photograph's pose before the search.
struct PhotographPrior {
  /// Of north, east, yaw, tilt_north, tilt_east and up, in this order.
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  Eigen::Vector3d p_n;  ///< of the camera
  Eigen::Quaterniond q_n_c;
  double sigma_m = 10;  ///< of north and east each
  double height_sigma_m = 0.6;
  double yaw_sigma_rad = 0.35, tilt_sigma_rad = 0.01;
  /// Of the camera above the model's ground, where it has some: p_n's down is ignored then. None: p_n's down is right.
  std::optional<double> eye_m = 1.6;
  double wrong_heading = 0.05;  ///< fraction of compasses that are wrong by any angle; judgement

  /// Negative log-likelihood of a guess over that of the prior's own pose.
  double cost(const Guess& guess) const;
  /// Second derivatives of the cost, with the heading's averaged over both cases of the compass.
  Vector6 information(const Guess& guess) const;
  /// Of the six standard deviations; that of a heading that is unknown is limited.
  double log_volume() const;

 private:
  Vector6 sigmas() const;
  std::array<double, 2> heading_likelihoods(double yaw) const;
};

/// Covariance of north and east, m^2, without the part of the prior, which an estimator that fuses it has already.
/// `min_sigma_m`: of the model's corners, part of the covariance; `unobserved_sigma_m`: of a direction that the picture
/// does not determine.
Eigen::Matrix2d covariance_without_prior(const Eigen::Matrix2d& covariance, double prior_sigma_m, double min_sigma_m,
                                         double unobserved_sigma_m = MatcherParameters().unobserved_sigma_m);

}  // namespace odograph::skyline
