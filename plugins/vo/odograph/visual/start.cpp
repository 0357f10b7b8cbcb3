// SPDX-License-Identifier: Apache-2.0
//
// How a map begins: from a rotation alone to two views with depths.
#include <cmath>

#include "plugins/shared/camera/two_view.hpp"
#include "plugins/vo/odograph/visual/odometry.hpp"
#include "plugins/vo/odograph/visual/shared.hpp"

namespace odograph::vo {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kStartTrials = 200;
constexpr double kTurnAgrees = 1.5;  // of the parallax
constexpr double kStartTurn = 0.25;  // of the parallax: what a start leaves uncertain of the turn
constexpr double kLearnAfter_s = 0.4;
constexpr double kBiasKnown_radps = 0.0005;

}  // namespace

/// Before there is a map: the rotation alone, until there is enough parallax to start one. False where the reference
/// has been lost from sight.
bool Odometry::start_or_turn(Motion& motion) {
  std::vector<cv::Point2d> first, second;
  std::vector<size_t> which;
  const auto& landmarks = window_.landmarks();
  for (size_t i = 0; i < seen_.size(); ++i) {
    const auto found = landmarks.find(seen_[i].track);
    if (found == landmarks.end()) continue;
    const Vector2d& a = found->second.seen.front().seen;
    first.emplace_back(a.x(), a.y()), second.emplace_back(seen_[i].at.x(), seen_[i].at.y());
    which.push_back(i);
  }
  motion.state = Tracking::lost;
  motion.failure = tracker_.mean_grey() < kDarkGrey ? FailureReason::too_dark : FailureReason::few_features;
  if (turn_) {  // the picture may say nothing, the gyroscope does
    motion.q_c0_c1 = turn_->q_c0_c1;
    motion.covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * turn_->sigma_rad * turn_->sigma_rad;
    motion.rotation_valid = true;
  }
  const auto rotation = pure_rotation(first, second);
  if (!rotation) return false;
  motion.state = Tracking::degraded;
  motion.failure = FailureReason::no_parallax;
  const Quaterniond q_w_c(rotation->R_1_0.transpose());
  learn_bias(q_w_c, std::max(sigma(), rotation->median_residual_rad));
  if (rotation->median_residual_rad > 0.25 * kStartParallax_rad && start(motion, first, second, which, q_w_c))
    return true;
  const double sigma_rad =
      std::max(sigma(), rotation->median_residual_rad) / std::sqrt(static_cast<double>(first.size()));
  if (!motion.rotation_valid) {
    motion.q_c0_c1 = (Quaterniond(T_w_c_.linear()).conjugate() * q_w_c).normalized();
    motion.covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * sigma_rad * sigma_rad;
    motion.rotation_valid = true;
  }
  T_w_c_.linear() = T_w_c_.linear() * motion.q_c0_c1.toRotationMatrix();
  last_step_ = isometry(motion.q_c0_c1, Vector3d::Zero());
  motion.inliers = static_cast<unsigned>(first.size());
  return true;
}

/// Without a way the picture's turn since the reference has no drift, the gyroscope's has.
void Odometry::learn_bias(const Quaterniond& seen_rotation, double sigma_rad) {
  const double since_s = static_cast<double>(last_ns_ - reference_ns_) * 1e-9 + step_s_;
  if (!turn_ || since_s < kLearnAfter_s) return;
  const auto turn = gyroscope_.between(reference_ns_, reference_ns_ + static_cast<int64_t>(since_s * 1e9), bias_c_);
  const double sigma = sigma_rad / since_s, variance = bias_sigma_ * bias_sigma_;
  if (!turn || sigma > bias_sigma_) return;
  bias_c_ += variance / (variance + sigma * sigma) * log_rotation(seen_rotation.conjugate() * turn->q_c0_c1) / since_s;
  bias_sigma_ = std::max(kBiasKnown_radps, sigma);
}

bool Odometry::start(Motion& motion, const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                     const std::vector<size_t>& which, const Quaterniond& turn_alone) {
  const auto pair = two_view_near(first, second, turn_alone.conjugate().toRotationMatrix(), 3 * sigma(), kStartTrials);
  if (!pair || pair->count < kLeastPoints || 2 * static_cast<size_t>(pair->count) < first.size() ||
      pair->median_parallax_rad < kStartParallax_rad) {
    if (!pair || 2 * static_cast<size_t>(pair->count) < first.size())
      noise_px_ = std::min(kMostNoise_px, kCoarser * noise_px_);
    return false;
  }
  // With little parallax a wrong way can be made up for by a wrong turn; but by no more than the parallax allows.
  const Quaterniond q_w_c(pair->R_1_0.transpose());
  if (q_w_c.angularDistance(turn_alone) > kTurnAgrees * pair->median_parallax_rad) return false;
  Isometry3d T_1_0 = Isometry3d::Identity();
  T_1_0.linear() = pair->R_1_0;
  T_1_0.translation() = pair->t_1_0;
  Isometry3d T_w_c = T_1_0.inverse();
  // The unit: the median depth of the first points is one.
  std::vector<double> depths;
  for (size_t i = 0; i < which.size(); ++i)
    if (pair->inliers[i])
      if (const auto X =
              triangulate({{Isometry3d::Identity(), first[i]}, {T_w_c, second[i]}}, 0.02, kPointParallax_rad))
        depths.push_back(X->z());
  if (static_cast<int>(depths.size()) < kLeastPoints) return false;
  T_w_c.translation() /= median(depths);
  // Everything since the reference is this motion's: the rotation was told before, the way is told now.
  motion.q_c0_c1 = (Quaterniond(T_w_c_.linear()).conjugate() * Quaterniond(T_w_c.linear())).normalized();
  motion.p_c0_c1 = T_w_c_.linear().transpose() * T_w_c.translation();
  motion.rotation_valid = motion.translation_valid = true;
  // What the turns told since the reference were off by is in this one.
  const double blind_s = static_cast<double>(last_ns_ - reference_ns_) * 1e-9 + step_s_;
  const double turn_sigma = std::hypot(kStartTurn * pair->median_parallax_rad, turn_ ? bias_sigma_ * blind_s : 0.0);
  const double way_sigma = 0.1 * motion.p_c0_c1.norm();
  motion.covariance.setZero();
  motion.covariance.diagonal().head<3>().setConstant(turn_sigma * turn_sigma);
  motion.covariance.diagonal().tail<3>().setConstant(way_sigma * way_sigma);
  motion.state = Tracking::tracking;
  motion.failure = FailureReason::none;
  motion.inliers = static_cast<unsigned>(pair->count);
  for (size_t i = 0; i < which.size(); ++i)
    if (!pair->inliers[i]) window_.forget(seen_[which[i]].track);
  const double frames =
      std::max(1.0, std::round(static_cast<double>(last_ns_ - reference_ns_) * 1e-9 / std::max(step_s_, 1e-3)) + 1);
  last_step_ = isometry(turn_ ? turn_->q_c0_c1 : motion.q_c0_c1, motion.p_c0_c1 / frames);
  last_step_s_ = step_s_;
  T_w_c_ = T_w_c;
  last_covariance_ = motion.covariance;
  started_ = true;
  return true;
}

/// The latest frame becomes the first of a new map; its corners are what is known.
void Odometry::begin(const Frame& frame, bool new_group) {
  if (new_group) ++group_;
  have_reference_ = true;
  started_ = false;
  relocalising_since_ns_.reset();
  relocalisation_keyframe_.reset();
  doubts_ = 0;
  window_.clear();
  T_w_c_.setIdentity(), T_k_c_.setIdentity();
  if (new_group) last_step_.setIdentity();
  last_step_.translation().setZero();
  last_covariance_.setZero();
  reference_ns_ = frame.t_ns;
  tracker_.refill(frame.mask);
  undistort_tracks(frame);
  window_.add({0, frame.t_ns, T_w_c_, std::nullopt, bias_c_});
  for (const Seen& s : seen_) window_.observe(s.track, s.at);
  seen_at_keyframe_ = seen_.size();
}

}  // namespace odograph::vo
