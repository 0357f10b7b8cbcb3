// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/photograph_decision.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Dense>

namespace odograph::skyline {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kThreeSigma2 = 11.829;  // chi-square of two degrees of freedom, 99.73 %

template <class... Numbers>
std::string format_text(const char* format, Numbers... numbers) {
  char text[200];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

/// The place's log_volume, but no sharper than the model's corners.
double log_volume_of(const PhotographPlace& place, const PhotographDecisionParameters& p) {
  const double corner_m2 = p.min_sigma_m * p.min_sigma_m;
  Eigen::Matrix3d blurred = place.covariance;
  blurred.diagonal() += Eigen::Vector3d(corner_m2, corner_m2, corner_m2 / (p.roof_distance_m * p.roof_distance_m));
  return place.log_volume + 0.5 * std::log(blurred.determinant() / place.covariance.determinant());
}

/// Covariance, and the probability that the camera is beyond three of its sigmas or not in the model at all, over the
/// places of all attempts, by a power of their likelihoods (Wedderburn 1974): the model's errors are not those assumed.
void estimate_uncertainty(const std::vector<PhotographAttempt>& attempts, const PhotographAttempt& best,
                          const PhotographDecisionParameters& p, PhotographDecision& decision) {
  Match& match = *decision.tried;
  const PhotographPlace& at = best.places.front();
  const auto cost = [&](const PhotographAttempt& of, const PhotographPlace& c) {
    // A sky with fewer edges has less to gain, and skies' likelihoods are hardly comparable.
    const PhotographPlace& first = of.places.front();
    const double facades = first.facade_gain;
    const double gain = facades + (first.gain - facades) * std::max(1.0, best.possible_gain / of.possible_gain);
    const double less = p.sky_power * std::max(0.0, at.gain - gain) + first.gain - c.gain;
    return std::max(0.0, less);
  };
  const auto offset = [&](const PhotographPlace& c) {
    Eigen::Vector3d d = c.at - at.at;
    d.z() = std::remainder(d.z(), 2 * std::numbers::pi);
    return d;
  };
  const auto for_each = [&](const auto& with) {
    for (const PhotographAttempt& attempt : attempts)
      for (const PhotographPlace& c : attempt.places) with(cost(attempt, c), offset(c), c);
  };
  // Spread about the best place, which is the estimate, not about the mean, of the places around it.
  double all = 0, within = 0, others = 0;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for_each([&](double less, const Eigen::Vector3d& d, const PhotographPlace& c) {
    all += std::exp(-p.power * less);
    if (d.head<2>().norm() > p.mode_radius_m) return;
    const double w = std::exp(-p.spread_power * less);
    within += w, spread += w * (c.covariance + d * d.transpose());
  });
  spread /= within;
  match.covariance = spread.topLeftCorner<2, 2>() + p.min_sigma_m * p.min_sigma_m * Eigen::Matrix2d::Identity();
  // Several places nearby are not a Gaussian: its three sigmas are those that hold.
  for (double near = 1e9; near > p.max_near * all;) {
    const Eigen::Matrix2d information = match.covariance.inverse();
    near = others = 0;
    for_each([&](double less, const Eigen::Vector3d& d, const PhotographPlace&) {
      const double w = std::exp(-p.power * less);
      if (!(d.head<2>().dot(information * d.head<2>()) > kThreeSigma2)) return;  // nor where it is not a number
      others += w;
      if (d.head<2>().norm() <= p.mode_radius_m) near += w;
    });
    if (near > p.max_near * all) match.covariance *= 1.2;
  }
  // Likelihood that what was searched has nothing of the picture: one run of directions, over the evidence of the best
  // place by Laplace's approximation, or straight roofs. A right place has most of the line in the model.
  const double share = (p.modelled_power + 1) * std::pow(std::max(match.agreement, 1e-6), p.modelled_power);
  const double gain = at.gain - at.facade_gain + std::min(at.facade_gain, p.facade_evidence);
  const double odds = (p.unmodelled + best.outside) / std::max(1 - best.outside, 1e-6);
  const double volume = log_volume_of(at, p);
  const double straight =
      p.straight_roofs ? std::exp(std::min(50.0, -p.straight_volume * volume - best.straight_gain)) : 0;
  const double none = odds * (std::exp(std::min(50.0, -volume - p.power * gain)) / share + straight);
  const double chance = none / (1 + none);  // the same place by several attempts is no more evidence
  decision.other = chance + (1 - chance) * others / all;
  decision.chance = chance > 0.5 * decision.other;
  match.second_best_ratio = decision.other;
  match.yaw_sigma_rad = std::hypot(std::sqrt(spread(2, 2)), p.min_sigma_m / p.roof_distance_m);
}

}  // namespace

PhotographDecision decide(const std::vector<PhotographAttempt>& attempts, const PhotographDecisionParameters& p) {
  const PhotographAttempt& best = *std::max_element(attempts.begin(), attempts.end(), [](const auto& x, const auto& y) {
    return x.places.front().gain < y.places.front().gain;
  });
  PhotographDecision decision{.tried = best.match, .gain = best.places.front().gain};
  estimate_uncertainty(attempts, best, p, decision);
  const Match& match = *decision.tried;
  const double worst_m = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(match.covariance).eigenvalues()[1]);
  // Numbers that fall short are rounded away from those required.
  const auto refuse = [&](Reason reason, const char* format, auto... numbers) {
    decision.reason = reason, decision.why = format_text(format, numbers...);
  };
  if (!match.covariance.allFinite() || !std::isfinite(decision.other))
    refuse(kAmbiguity, "%s", "the visible roofs do not determine the place");
  else if (match.agreement < p.min_agreement)
    refuse(kAgreement, "only %.0f %% of the sky's edge coincides with a roof of the model; %.0f %% are required",
           std::floor(100 * match.agreement), 100 * p.min_agreement);
  else if (decision.other > p.max_other)
    refuse(kAmbiguity,
           decision.chance ? "%.0f %% of the sky's edge coincides with a roof of the model, but the probability that "
                             "this is chance is %.0f %%; at most %.0f %% are accepted"
                           : "%.0f %% of the sky's edge coincides with a roof of the model, but the probability of "
                             "other places is %.0f %%; at most %.0f %% are accepted",
           std::floor(100 * match.agreement), std::ceil(100 * decision.other), 100 * p.max_other);
  else if (worst_m > p.max_sigma_m)
    refuse(kAmbiguity, "the visible roofs determine the place only to %.1f m; %.1f m are required",
           0.1 * std::ceil(10 * worst_m), p.max_sigma_m);
  else if (match.yaw_sigma_rad > p.max_yaw_sigma_rad)
    refuse(kAmbiguity, "the visible roofs determine the heading only to %.0f degrees; %.0f are required",
           std::ceil(match.yaw_sigma_rad * kDegrees), p.max_yaw_sigma_rad * kDegrees);
  return decision;
}

}  // namespace odograph::skyline
