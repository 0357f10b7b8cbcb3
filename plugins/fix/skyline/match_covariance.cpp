// SPDX-License-Identifier: Apache-2.0
//
// Uncertainty of a match.
#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "plugins/fix/skyline/match_terms.hpp"
#include "plugins/fix/skyline/matcher.hpp"

namespace odograph::skyline {
namespace {

/// Factor from a mean loss to a log-likelihood.
double to_log(double directions, double best_cost, const MatcherParameters& p) {
  return directions / (p.correlated * std::max(p.noise_rad, 0.5 * best_cost));
}

}  // namespace

/// Evaluates the places around the best one, each with the heading and the inclination that fit it best, and refines
/// the likeliest. A wall along a street is a ridge narrower than the lattice's cells, which the lattice misses.
void Matcher::sample_neighbours(const Place& best) {
  around_.clear();
  for (int a = -p_.neighbours; a <= p_.neighbours; ++a)
    for (int b = -p_.neighbours; b <= p_.neighbours; ++b) {
      if (a == 0 && b == 0) continue;
      Place there = best;
      there.guess.north += a * p_.neighbour_step_m, there.guess.east += b * p_.neighbour_step_m;
      there.cost = cost(there.guess, true);
      align_heading(there);
      around_.push_back(there);
    }
  std::sort(around_.begin(), around_.end(), by_cost);
  std::vector<Place> starts;
  for (const Place& p : around_) {
    if (std::any_of(starts.begin(), starts.end(),
                    [&](const Place& s) { return apart(s.guess, p.guess) < p_.spread_m; }))
      continue;
    starts.push_back(p);
    if (starts.size() == p_.neighbour_starts) break;
  }
  for (const Place& p : starts) around_.push_back(refine(p));
}

/// Spread of the places around the best one that fit nearly as well. Where one at the rim does, the ridge continues
/// beyond it: the picture does not determine the position along that direction.
Matcher::Spread Matcher::spread_around(const Place& best, double scale) const {
  Eigen::Matrix2d cloud = Eigen::Matrix2d::Zero(), open = Eigen::Matrix2d::Zero();
  double weight = 1, turned = 0;  // of the best place itself
  for (const Place& p : around_) {
    const double w = std::min(1.0, std::exp(-scale * (p.cost - best.cost)));
    const Eigen::Vector2d d(p.guess.north - best.guess.north, p.guess.east - best.guess.east);
    const double yaw = p.guess.yaw - best.guess.yaw;
    cloud += w * d * d.transpose(), turned += w * yaw * yaw, weight += w;
    if (w > p_.alike && d.norm() > p_.neighbours * p_.neighbour_step_m - 0.5 * p_.neighbour_step_m) {
      const Eigen::Vector2d along = d.normalized();
      open = p_.unobserved_sigma_m * p_.unobserved_sigma_m * along * along.transpose();
    }
  }
  return {cloud / weight + open, turned / weight};
}

/// Covariance from the curvature of the fit and the spread of the lattice, and the likelihood of another place. False
/// where the picture alone does not determine the place.
bool Matcher::estimate_covariance(const Place& best, double second_best_cost, Match& match) {
  const double scale = to_log(seen_.total_weight() / seen_.correlated(), best.cost, p_);
  match.second_best_ratio = second_best_cost < 1e9 ? std::exp(-scale * (second_best_cost - best.cost)) : 0.0;
  // Places along a uniform street fit equally well: their spread is part of the covariance.
  Eigen::Matrix2d cloud = Eigen::Matrix2d::Zero();
  double weight = 0;
  const auto spread = [&](const std::vector<Place>& places, double min_cost) {
    for (const Place& place : places) {
      const double w = std::exp(-scale * (place.cost - min_cost));
      const Eigen::Vector2d d(place.guess.north - best.guess.north, place.guess.east - best.guess.east);
      cloud += w * d * d.transpose(), weight += w;
    }
  };
  spread(places_, places_.front().cost);
  spread(ends_, best.cost);
  cloud /= weight;
  const Spread around = spread_around(best, scale);
  cloud += around.position;
  Matrix6d H;
  Vector6d b;
  linearise(best.guess, p_.soft_rad, H, b);
  // The residual beyond the noise is model error, which does not average out.
  const double left = std::max(1.0, best.cost / p_.noise_rad);
  H.diagonal().head<2>().array() += 1.0 / (p_.unobserved_sigma_m * p_.unobserved_sigma_m);
  H(3, 3) += 1.0;
  const Matrix6d P = H.inverse() * (left * left);
  // The fewer directions agree, the more of them agree by chance.
  const double disagreement_sigma_m = p_.disagreement_m * (1 - match.agreement);
  match.covariance =
      P.topLeftCorner<2, 2>() + cloud + Eigen::Matrix2d::Identity() * (disagreement_sigma_m * disagreement_sigma_m);
  match.height_sigma_m = std::sqrt(std::max(1e-6, P(2, 2)));
  match.yaw_sigma_rad =
      std::clamp(std::sqrt(std::max(0.0, P(3, 3)) + around.yaw_variance), 0.1 * kDegree, 30 * kDegree);
  const double narrowest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(P.topLeftCorner<2, 2>()).eigenvalues()[0];
  return narrowest < p_.max_axis_sigma_m * p_.max_axis_sigma_m;
}

}  // namespace odograph::skyline
