// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/five_point/visual_odometry.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>

namespace odograph::five_point {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d isometry(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  cv::Matx33d R;
  cv::Rodrigues(rotation_vector, R);
  Isometry3d T = Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) T.linear()(i, j) = R(i, j);
    T.translation()[i] = translation.at<double>(i);
  }
  return T;
}

void split(const Isometry3d& T, cv::Mat& rotation_vector, cv::Mat& translation) {
  cv::Matx33d R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = T.linear()(i, j);
  cv::Rodrigues(R, rotation_vector);
  translation = (cv::Mat_<double>(3, 1) << T.translation().x(), T.translation().y(), T.translation().z());
}

}  // namespace

Motion VisualOdometry::process(const cv::Mat& grey, const cv::Mat& mask) {
  Motion motion;
  const bool shows = content_of(grey).has_content(p_.content);
  shows ? tracker_.follow(grey) : tracker_.skip();
  std::vector<cv::Point2f> pixels;
  for (const auto& track : tracker_.tracks()) pixels.push_back(track.pixel);
  camera_.undistort(pixels, normalized_);
  motion.tracked = static_cast<unsigned>(pixels.size());

  const Isometry3d T_w_c0 = T_w_c_;
  if (!have_reference_) {
    begin(false);
  } else if (started_) {
    if (estimate_pose(motion) && agrees_with_two_views(T_w_c0)) {
      extend_map();
    } else {
      motion = Motion{.tracked = motion.tracked};
      motion.state = Tracking::lost;
      motion.failure = shows ? FailureReason::few_features : FailureReason::too_dark;
      begin(true);
    }
  } else if (!try_start(motion)) {
    motion.state = motion.tracked < static_cast<unsigned>(p_.min_inliers) ? Tracking::lost : Tracking::degraded;
    motion.failure = !shows                           ? FailureReason::too_dark
                     : motion.state == Tracking::lost ? FailureReason::few_features
                                                      : FailureReason::no_parallax;
  }
  if (motion.translation_valid) {
    last_step_ = T_w_c0.inverse() * T_w_c_;
    motion.q_c0_c1 = Eigen::Quaterniond(last_step_.linear()).normalized();
    motion.p_c0_c1 = last_step_.translation();
    motion.rotation_valid = true;
  }
  motion.scale_group = group_;
  previous_.clear();
  for (size_t i = 0; i < tracker_.tracks().size(); ++i) previous_[tracker_.tracks()[i].id] = normalized_[i];
  tracker_.refill(mask);
  return motion;
}

std::vector<TrackedCorner> VisualOdometry::corners() const {
  std::vector<TrackedCorner> out;
  for (size_t i = 0; i < normalized_.size(); ++i) {
    const auto& [id, pixel] = tracker_.tracks()[i];
    const auto point = points_.find(id);
    const bool used = point != points_.end() && point->second.triangulated && point->second.misses == 0;
    out.push_back({id, {normalized_[i].x, normalized_[i].y, 1}, Vector3d::Zero(), {pixel.x, pixel.y}, used});
  }
  return out;
}

/// Makes the latest frame the reference of a new map, with its corners alone.
void VisualOdometry::begin(bool new_group) {
  if (new_group) ++group_;
  have_reference_ = true;
  started_ = false;
  contradiction_.setZero();
  since_start_ = 0;
  points_.clear();
  reference_.clear();
  T_w_c_.setIdentity();
  last_step_.setIdentity();
  for (size_t i = 0; i < tracker_.tracks().size(); ++i) reference_[tracker_.tracks()[i].id] = normalized_[i];
}

bool VisualOdometry::try_start(Motion& motion) {
  std::vector<cv::Point2d> first, second;
  std::vector<uint64_t> ids;
  for (size_t i = 0; i < tracker_.tracks().size(); ++i) {
    const auto seen = reference_.find(tracker_.tracks()[i].id);
    if (seen == reference_.end()) continue;
    first.push_back(seen->second);
    second.push_back(normalized_[i]);
    ids.push_back(seen->first);
  }
  const auto rotation = pure_rotation(first, second);
  if (!rotation) {
    begin(false);
    return false;
  }
  std::optional<TwoView> pair;
  const bool moved = rotation->median_residual_rad > 0.25 * p_.start_parallax_rad;
  if (moved) pair = two_view(first, second, threshold());
  if (!moved || (pair && pair->median_parallax_rad < p_.start_parallax_rad)) {
    // Without parallax the rotation is still valid; the position stays unchanged.
    const Eigen::Matrix3d R_0_1 = (pair ? pair->R_1_0 : rotation->R_1_0).transpose();
    motion.inliers = static_cast<unsigned>(pair ? static_cast<size_t>(pair->count) : first.size() / 2);
    motion.q_c0_c1 = Eigen::Quaterniond(T_w_c_.linear().transpose() * R_0_1).normalized();
    motion.rotation_valid = true;
    motion.rotation_sigma_rad =
        std::max(threshold(), rotation->median_residual_rad) / std::sqrt(static_cast<double>(first.size()));
    T_w_c_.linear() = R_0_1;
    if (first.size() * 2 < reference_.size()) begin(false);
    return false;
  }
  if (!pair || pair->count < p_.min_inliers) {
    begin(false);
    return false;
  }
  motion.inliers = static_cast<unsigned>(pair->count);
  Isometry3d T_1_0 = Isometry3d::Identity();
  T_1_0.linear() = pair->R_1_0;
  T_1_0.translation() = pair->t_1_0;
  T_w_c_ = T_1_0.inverse();
  for (size_t i = 0; i < ids.size(); ++i) {
    Point point;
    point.sightings = {{Isometry3d::Identity(), first[i]}, {T_w_c_, second[i]}};
    if (pair->inliers[i]) {
      if (const auto X = triangulate(point.sightings, threshold(), 0.5 * p_.point_parallax_rad)) {
        point.X_w = *X;
        point.triangulated = true;
      }
      points_[ids[i]] = std::move(point);
    }
  }
  started_ = true;
  motion.translation_valid = true;
  motion.state = Tracking::tracking;
  motion.failure = FailureReason::none;
  motion.rotation_sigma_rad = threshold() / std::sqrt(static_cast<double>(pair->count));
  motion.position_sigma = 0.1;
  return true;
}

/// A distorted map still yields inliers and bends the path slowly. The mean of the frame rotations by the map must
/// therefore agree with that by the two latest pictures, which do not depend on the map.
bool VisualOdometry::agrees_with_two_views(const Isometry3d& T_w_c0) {
  if (++since_start_ % p_.check_every != 0) return true;
  std::vector<cv::Point2d> first, second;
  for (size_t i = 0; i < tracker_.tracks().size(); ++i)
    if (const auto seen = previous_.find(tracker_.tracks()[i].id); seen != previous_.end()) {
      first.push_back(seen->second);
      second.push_back(normalized_[i]);
    }
  const auto pair = two_view(first, second, threshold());
  if (!pair || 2 * static_cast<size_t>(pair->count) < first.size() || pair->median_parallax_rad < p_.start_parallax_rad)
    return true;  // no two-view estimate to compare with
  const Eigen::AngleAxisd difference(pair->R_1_0 * T_w_c0.linear().transpose() * T_w_c_.linear());
  const double most = 2 * p_.contradiction_rad;  // limits the effect of one wrong pair of views
  contradiction_ = 0.6 * contradiction_ + 0.4 * std::min(difference.angle(), most) * difference.axis();
  return contradiction_.norm() < p_.contradiction_rad;
}

/// Rejects poses that put the seen points behind the camera or rotate by more than a hand can between two frames: the
/// mirrored pose of a near plane, or a chance agreement of few points.
bool VisualOdometry::plausible(const Isometry3d& T_c_w, const Isometry3d& T_predicted,
                               const std::vector<cv::Point3d>& inliers, size_t asked) const {
  if (4 * inliers.size() < asked) return false;
  if (Eigen::AngleAxisd(T_c_w.linear() * T_predicted.linear()).angle() > p_.max_deviation_rad) return false;
  size_t behind = 0;
  for (const auto& X : inliers) behind += (T_c_w * Vector3d(X.x, X.y, X.z)).z() <= 0;
  return 20 * behind <= inliers.size();
}

/// Pose of the frame by PnP: RANSAC from the predicted pose, then Levenberg-Marquardt on the inliers.
bool VisualOdometry::estimate_pose(Motion& motion) {
  std::vector<cv::Point3d> world;
  std::vector<cv::Point2d> image;
  std::vector<uint64_t> ids;
  for (size_t i = 0; i < tracker_.tracks().size(); ++i) {
    const auto found = points_.find(tracker_.tracks()[i].id);
    if (found == points_.end() || !found->second.triangulated) continue;
    world.emplace_back(found->second.X_w.x(), found->second.X_w.y(), found->second.X_w.z());
    image.push_back(normalized_[i]);
    ids.push_back(found->first);
  }
  if (static_cast<int>(world.size()) < p_.min_inliers) return false;
  cv::Mat r, t, inliers;
  split((T_w_c_ * last_step_).inverse(), r, t);
  const cv::Matx33d K = cv::Matx33d::eye();
  const bool solved = cv::solvePnPRansac(world, image, K, cv::noArray(), r, t, true, 200,
                                         static_cast<float>(2 * threshold()), 0.999, inliers, cv::SOLVEPNP_ITERATIVE);
  if (!solved || inliers.rows < p_.min_inliers) return false;
  std::vector<cv::Point3d> good_world;
  std::vector<cv::Point2d> good_image;
  std::vector<char> is_inlier(ids.size(), 0);
  for (int k = 0; k < inliers.rows; ++k) {
    const auto i = static_cast<size_t>(inliers.at<int>(k));
    is_inlier[i] = 1;
    good_world.push_back(world[i]);
    good_image.push_back(image[i]);
  }
  cv::solvePnPRefineLM(good_world, good_image, K, cv::noArray(), r, t);
  const Isometry3d T_c_w = isometry(r, t), T_predicted = T_w_c_ * last_step_;
  if (!plausible(T_c_w, T_predicted, good_world, world.size())) return false;
  T_w_c_ = T_c_w.inverse();
  double depth = 0.0;
  for (size_t i = 0; i < ids.size(); ++i) {
    Point& point = points_[ids[i]];
    point.misses = is_inlier[i] ? 0 : point.misses + 1;
    if (point.misses > 2)
      points_.erase(ids[i]);  // a moving point or a bad triangulation; the track may be triangulated again
  }
  for (const auto& X : good_world) depth += (T_w_c_.inverse() * Vector3d(X.x, X.y, X.z)).z();
  depth /= static_cast<double>(good_world.size());
  motion.inliers = static_cast<unsigned>(good_world.size());
  motion.translation_valid = true;
  motion.state = Tracking::tracking;
  motion.failure = FailureReason::none;
  motion.rotation_sigma_rad = threshold() / std::sqrt(static_cast<double>(good_world.size()));
  motion.position_sigma = motion.rotation_sigma_rad * depth;
  return true;
}

/// Adds the observations of this frame, triangulates points that now have parallax and refines those that gained some.
void VisualOdometry::extend_map() {
  std::unordered_map<uint64_t, Point> alive;
  alive.reserve(tracker_.tracks().size());
  for (size_t i = 0; i < tracker_.tracks().size(); ++i) {
    const uint64_t id = tracker_.tracks()[i].id;
    Point point;
    if (const auto found = points_.find(id); found != points_.end()) point = std::move(found->second);
    point.sightings.push_back({T_w_c_, normalized_[i]});
    // Keeps the first and the newest observations: largest parallax at constant cost.
    if (point.sightings.size() > p_.sightings) point.sightings.erase(point.sightings.begin() + 1);
    if (point.sightings.size() >= 2) {
      if (const auto X = triangulate(point.sightings, 2 * threshold(), p_.point_parallax_rad)) {
        point.X_w = *X;
        point.triangulated = true;
      }
    }
    alive[id] = std::move(point);
  }
  points_.swap(alive);
}

}  // namespace odograph::five_point
