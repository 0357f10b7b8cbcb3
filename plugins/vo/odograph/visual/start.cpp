// SPDX-License-Identifier: Apache-2.0
//
// Starting a map: from pure rotation to two views with depths.
#include <algorithm>
#include <cmath>

#include "plugins/shared/camera/two_view.hpp"
#include "plugins/shared/median.hpp"
#include "plugins/vo/odograph/visual/odometry.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph::vo {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;

}  // namespace

/// Makes the latest frame the reference of a new map, with its corners alone.
Initialising Odometry::begin(const Frame& frame) {
  window_.clear();
  track_.T_w_c.setIdentity(), track_.T_k_c.setIdentity();
  track_.last_step.translation().setZero();
  track_.covariance.setZero();
  tracker_.refill(frame.mask);
  seen_ = undistort(frame);
  window_.add({0, frame.t_ns, track_.T_w_c, std::nullopt, bias_c_});
  for (const SeenCorner& corner : seen_.corners) window_.observe(corner.track, corner.at);
  return {frame.t_ns, seen_.corners.size()};
}

/// The same after a map was lost, with a new scale group.
Initialising Odometry::begin_group(const Frame& frame) {
  ++group_;
  track_.last_step.setIdentity();
  return begin(frame);
}

Odometry::Matches Odometry::matches_with_reference() const {
  Matches matches;
  const auto& landmarks = window_.landmarks();
  for (size_t i = 0; i < seen_.corners.size(); ++i) {
    const auto found = landmarks.find(seen_.corners[i].track);
    if (found == landmarks.end()) continue;
    const Eigen::Vector2d &a = found->second.seen.front().seen, &b = seen_.corners[i].at;
    matches.first.emplace_back(a.x(), a.y()), matches.second.emplace_back(b.x(), b.y());
    matches.which.push_back(i);
  }
  return matches;
}

/// Without displacement the visual rotation since the reference is drift-free, unlike the gyroscope's: estimates the
/// bias.
void Odometry::update_bias(const Initialising& state, const Prediction& predicted, const Quaterniond& seen_rotation,
                           double sigma_rad) {
  const double since_s = seconds(last_ns_ - state.reference_ns) + predicted.step_s;
  if (!predicted.gyro || since_s < p_.gyroscope.min_bias_s) return;
  const auto gyro = gyroscope_.between(state.reference_ns, state.reference_ns + nanoseconds(since_s), bias_c_);
  const double sigma = sigma_rad / since_s, variance = bias_sigma_ * bias_sigma_;
  if (!gyro || sigma > bias_sigma_) return;
  bias_c_ += variance / (variance + sigma * sigma) * log_rotation(seen_rotation.conjugate() * gyro->q_c0_c1) / since_s;
  bias_sigma_ = std::max(p_.gyroscope.known_bias_sigma_radps, sigma);
}

/// Nothing while there is too little parallax, or the motion is ambiguous.
std::optional<Odometry::SecondView> Odometry::find_second_view(const Matches& matches,
                                                               const Quaterniond& rotation_alone) {
  const MapStartParameters& p = p_.start;
  const auto pair = two_view_near(matches.first, matches.second, rotation_alone.conjugate().toRotationMatrix(),
                                  p.inlier_sigmas * sigma(), p.trials);
  if (!pair || pair->count < p.min_inliers * static_cast<double>(matches.first.size())) {
    noise_px_ = std::min(p_.noise.max_px, p_.noise.coarser * noise_px_);
    return std::nullopt;
  }
  if (pair->count < p_.pose.min_points || pair->median_parallax_rad < p.min_parallax_rad) return std::nullopt;
  const Quaterniond q_w_c(pair->R_1_0.transpose());
  if (q_w_c.angularDistance(rotation_alone) > p.rotation_agrees * pair->median_parallax_rad) return std::nullopt;
  Isometry3d T_1_0 = Isometry3d::Identity();
  T_1_0.linear() = pair->R_1_0;
  T_1_0.translation() = pair->t_1_0;
  Isometry3d T_w_c = T_1_0.inverse();
  std::vector<double> depths;
  for (size_t i = 0; i < matches.which.size(); ++i)
    if (pair->inliers[i])
      if (const auto X = triangulate({{Isometry3d::Identity(), matches.first[i]}, {T_w_c, matches.second[i]}},
                                     p.triangulation_error, p_.keyframe.point_parallax_rad))
        depths.push_back(X->z());
  if (static_cast<int>(depths.size()) < p_.pose.min_points) return std::nullopt;
  T_w_c.translation() /= median(depths);
  return SecondView{T_w_c, pair->inliers, pair->count, pair->median_parallax_rad};
}

/// The rotation since the reference was reported with the earlier frames; the displacement all belongs to this frame.
Motion Odometry::begin_map(const SecondView& view, const Matches& matches, const Initialising& state,
                           const Prediction& predicted) {
  Motion motion{.tracked = static_cast<unsigned>(seen_.corners.size()), .inliers = static_cast<unsigned>(view.count)};
  motion.q_c0_c1 = (Quaterniond(track_.T_w_c.linear()).conjugate() * Quaterniond(view.T_w_c.linear())).normalized();
  motion.p_c0_c1 = track_.T_w_c.linear().transpose() * view.T_w_c.translation();
  motion.rotation_valid = motion.translation_valid = true;
  // The error of the rotations reported since the reference is part of this motion.
  const double since_s = seconds(last_ns_ - state.reference_ns) + predicted.step_s;
  const double rotation_sigma =
      std::hypot(p_.start.rotation_sigma * view.parallax_rad, predicted.gyro ? bias_sigma_ * since_s : 0.0);
  const double displacement_sigma = p_.start.displacement_sigma * motion.p_c0_c1.norm();
  motion.covariance.diagonal().head<3>().setConstant(rotation_sigma * rotation_sigma);
  motion.covariance.diagonal().tail<3>().setConstant(displacement_sigma * displacement_sigma);
  motion.state = Tracking::tracking;
  motion.failure = FailureReason::none;
  for (size_t i = 0; i < matches.which.size(); ++i)
    if (!view.inliers[i]) window_.remove_landmark(seen_.corners[matches.which[i]].track);
  const double frames =
      std::max(1.0, std::round(seconds(last_ns_ - state.reference_ns) / std::max(predicted.step_s, 1e-3)) + 1);
  track_.last_step = isometry(predicted.gyro ? predicted.gyro->q_c0_c1 : motion.q_c0_c1, motion.p_c0_c1 / frames);
  track_.last_step_s = predicted.step_s;
  track_.T_w_c = view.T_w_c;
  track_.covariance = motion.covariance;
  return motion;
}

}  // namespace odograph::vo
