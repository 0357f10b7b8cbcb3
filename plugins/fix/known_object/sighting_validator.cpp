// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/sighting_validator.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph::known_object {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

namespace {

/// Covariance of a pose from independent corner errors of `pixel_sigma`.
Matrix6 covariance_of_corners(const Pose& pose, const PlaneObject& object, const RollingLens& lens, double sigma_px) {
  Matrix6 H = 1e-6 * Matrix6::Identity();
  for (const Vector3d& corner : object.corners_o()) {
    const Vector3d p_c = pose * corner;
    const auto seen = lens.project(p_c);
    if (!seen) continue;
    Eigen::Matrix<double, 2, 6> J;
    J.leftCols<3>() = -seen->by_point * skew(p_c);
    J.rightCols<3>() = seen->by_point;
    H += J.transpose() * J / (sigma_px * sigma_px);
  }
  return H.inverse();
}

}  // namespace

void SightingValidator::clear() {
  encounters_.clear();
  path_at_fix_m_ = 0;
}

SightingValidator::Candidate SightingValidator::candidate(const Alignment& alignment, const PlaneObject& object,
                                                          const RollingLens& lens, const Prior& prior) const {
  const Pose& seen = alignment.pose;
  const Matrix6 by_picture = (alignment.information + 1e-6 * Matrix6::Identity()).inverse() +
                             covariance_of_corners(seen, object, lens, p_.pixel_sigma);
  // Gravity: the down direction in c by the prior against that of the object.
  const Matrix3d& R_n_o = object.place.R_n_o;
  const Vector3d down_o = R_n_o.transpose() * Vector3d::UnitZ();
  const Vector3d down_by_object = seen.R_c_o * down_o, down_by_prior = prior.q_n_c.conjugate() * Vector3d::UnitZ();
  // Survey errors tilt the object.
  const double lean = object.sigma_m / std::min(object.width_m, object.height_m);
  const double sigma = std::hypot(std::max(p_.gravity_sigma_rad, prior.tilt_sigma_rad), lean);
  Eigen::Matrix<double, 3, 6> G = Eigen::Matrix<double, 3, 6>::Zero();
  G.leftCols<3>() = -skew(down_by_object);
  const Vector3d off = down_by_prior - down_by_object;
  const Matrix6 information = by_picture.inverse();
  const Matrix6 H = information + G.transpose() * G / (sigma * sigma);
  const Matrix6 covariance = H.inverse();
  const Vector6 step = covariance * (G.transpose() * off / (sigma * sigma));
  const double by_gravity = (off - G * step).squaredNorm() / (sigma * sigma) + step.dot(information * step);
  const Pose pose = seen.moved(step);

  Candidate c;
  c.cost = alignment.cost + by_gravity;
  c.upright = by_gravity < p_.gate_sigmas * p_.gate_sigmas;
  Estimate& e = c.estimate;
  const Matrix3d R_n_c = R_n_o * pose.R_c_o.transpose();
  e.q_n_c = Eigen::Quaterniond(R_n_c).normalized();
  e.from_object_n = -(R_n_c * pose.t_c_o);
  e.p_n = object.place.p_n + e.from_object_n;
  e.correlation = alignment.correlation, e.oblique_rad = alignment.oblique_rad;
  // Survey errors rotate and shift the object; a focal length error scales the distance.
  const double w = object.width_m, h = object.height_m, s = object.sigma_m;
  const Vector3d rotation(s / h, s / w, s / std::hypot(w, h));
  const Matrix3d by_rotation = R_n_o * rotation.cwiseAbs2().asDiagonal() * R_n_o.transpose();
  const Matrix3d lever = skew(e.from_object_n);
  const Vector3d stretch = p_.focal_sigma * e.from_object_n;
  e.covariance_n = R_n_c * covariance.bottomRightCorner<3, 3>() * R_n_c.transpose() +
                   lever * by_rotation * lever.transpose() + stretch * stretch.transpose() +
                   Matrix3d::Identity() * (0.25 * s * s);
  e.orientation_covariance_n = R_n_c * covariance.topLeftCorner<3, 3>() * R_n_c.transpose() + by_rotation;
  c.is_plausible = is_plausible(e, prior);
  return c;
}

bool SightingValidator::is_plausible(const Estimate& e, const Prior& prior) const {
  const Vector3d off = e.p_n - prior.p_n;
  const double own_variance = std::max(e.covariance_n(0, 0), e.covariance_n(1, 1));
  if (!prior.placed)
    return prior.coarse_error_m <= 0 ||
           off.head<2>().norm() < prior.coarse_error_m + p_.gate_sigmas * std::sqrt(own_variance);
  // Position and heading jointly: a smaller print some metres aside, seen obliquely, is at the limit of each alone.
  const double drifted = p_.drift * std::max(0.0, prior.path_m - path_at_fix_m_);
  const auto cost = [](double by, double prior_sigma, double step_sigma, double variance) {
    return by * by / (prior_sigma * prior_sigma + step_sigma * step_sigma + variance);
  };
  const auto beyond_drift = [&](double by) { return std::max(0.0, by - drifted); };
  const Eigen::Quaterniond turned = e.q_n_c * prior.q_n_c.conjugate();
  const double yaw = std::remainder(2 * std::atan2(turned.z(), turned.w()), 2 * EIGEN_PI);
  return cost(beyond_drift(off.head<2>().norm()), prior.horizontal_sigma_m, p_.step_sigma_m, own_variance) +
             cost(beyond_drift(std::abs(off.z())), prior.vertical_sigma_m, p_.step_sigma_m, e.covariance_n(2, 2)) +
             cost(yaw, prior.yaw_sigma_rad, p_.step_sigma_rad, e.orientation_covariance_n(2, 2)) <
         p_.max_prior_cost;
}

/// True if the sighting is not a neighbouring copy of the object: on each side the position of a copy was seen to be
/// empty, or the prior excludes the camera position that a copy implies.
bool SightingValidator::excludes_copies(const Estimate& e, const PlaneObject& object, const Prior& prior,
                                        const Encounter& encounter) const {
  const double drifted = p_.drift * std::max(0.0, prior.path_m - path_at_fix_m_);
  Matrix3d covariance = e.covariance_n;
  covariance.diagonal() += Vector3d(std::hypot(prior.horizontal_sigma_m, drifted),
                                    std::hypot(prior.horizontal_sigma_m, drifted), prior.vertical_sigma_m)
                               .cwiseAbs2();
  const Matrix3d information = covariance.inverse();
  const auto cost = [&](const Vector3d& off) { return off.dot(information * off); };
  const Vector3d off = e.p_n - prior.p_n;
  for (size_t side = 0; side < kSides; ++side) {
    if (encounter.clear[side]) continue;
    // Taking a copy on the right for the object shifts the camera to the left.
    const Vector3d beside_o(kSideOffsets[side][0] * object.width_m, kSideOffsets[side][1] * object.height_m, 0);
    if (!prior.placed || cost(off - object.place.R_n_o * beside_o) - cost(off) < p_.unobserved_copy) return false;
  }
  return true;
}

/// True if the walker has stood in one position for stand_s.
bool SightingValidator::is_stationary(const Encounter& encounter, int64_t t_ns) const {
  Vector3d mean = Vector3d::Zero();
  size_t n = 0;
  for (const Observation& s : encounter.seen)
    if (seconds(t_ns - s.t_ns) <= p_.stand_s) mean += s.p_n, ++n;
  if (n < p_.min_standing || seconds(t_ns - encounter.seen.front().t_ns) < 0.9 * p_.stand_s) return false;
  mean /= static_cast<double>(n);
  for (const Observation& s : encounter.seen)
    if (seconds(t_ns - s.t_ns) <= p_.stand_s && (s.p_n - mean).norm() > p_.sway_m + 2 * s.sigma_m) return false;
  return true;
}

std::optional<Estimate> SightingValidator::validate(const Sighting& sighting, const PlaneObject& object,
                                                    const RollingLens& lens, const Prior& prior) {
  std::vector<Candidate> upright;
  for (const Alignment& alignment : sighting.poses) {
    Candidate c = candidate(alignment, object, lens, prior);
    if (c.upright) upright.push_back(std::move(c));
  }
  Encounter& encounter = encounters_[sighting.object];
  const auto reject = [&](uint64_t& reason) -> std::optional<Estimate> {
    ++reason;
    encounter.seen.clear();
    encounter.clear.fill(false);
    return std::nullopt;
  };
  if (upright.empty()) return reject(rejections_.not_upright);
  std::sort(upright.begin(), upright.end(), [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  std::vector<Candidate> left;
  for (Candidate& c : upright)
    if (c.cost - upright.front().cost < p_.ambiguous && c.is_plausible) left.push_back(c);
  if (left.empty()) return reject(rejections_.implausible_position);
  if (left.size() > 1) return reject(rejections_.ambiguous);
  Estimate estimate = left.front().estimate;
  estimate.object = sighting.object, estimate.t_ns = sighting.t_ns;
  const double sigma_m = std::sqrt(std::max(estimate.covariance_n(0, 0), estimate.covariance_n(1, 1)));
  if (!(sigma_m < p_.max_horizontal_sigma_m)) return reject(rejections_.large_sigma);

  const int64_t t = sighting.t_ns;
  if (!encounter.seen.empty()) {
    const Observation& last = encounter.seen.back();
    const double may_m = p_.max_speed_mps * seconds(t - last.t_ns) + 3 * std::hypot(sigma_m, last.sigma_m);
    if (t - last.t_ns > p_.gap_ns || (estimate.p_n - last.p_n).norm() > may_m) {
      encounter.seen.clear();
      encounter.clear.fill(false);
    }
  }
  for (size_t side = 0; side < kSides; ++side) encounter.clear[side] = encounter.clear[side] || sighting.clear[side];
  encounter.seen.push_back({t, estimate.p_n, sigma_m});
  while (seconds(t - encounter.seen.front().t_ns) > p_.stand_s + 1) encounter.seen.pop_front();
  const auto needed = static_cast<size_t>(p_.confirmations * (prior.placed ? 1 : 2));
  if (encounter.seen.size() < needed) return std::nullopt;
  if (!excludes_copies(estimate, object, prior, encounter)) {
    ++rejections_.possible_copy;
    return std::nullopt;
  }

  estimate.standing = is_stationary(encounter, t);
  const auto since = [&](int64_t last_fix_ns) { return last_fix_ns == INT64_MIN ? 1e9 : seconds(t - last_fix_ns); };
  int64_t& last_fix_ns = estimate.standing ? encounter.standing_fix_ns : encounter.last_fix_ns;
  if (since(last_fix_ns) < p_.interval_s) return std::nullopt;
  if (!estimate.standing && since(encounter.standing_fix_ns) < p_.hold_s) return std::nullopt;
  // The errors of fixes by one object are correlated: the factor gives them the information of independent ones.
  const double inflation = std::max(1.0, 2 * p_.correlation_s / std::max(p_.interval_s, since(last_fix_ns)));
  estimate.covariance_n *= inflation;
  estimate.orientation_covariance_n *= inflation;
  last_fix_ns = t;
  path_at_fix_m_ = prior.path_m;
  return estimate;
}

}  // namespace odograph::known_object
