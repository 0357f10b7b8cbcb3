// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/odometry.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "plugins/vo/odograph/visual/bundle.hpp"
#include "plugins/vo/odograph/visual/shared.hpp"

namespace odograph::vo {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr size_t kKeyframes = 8;
constexpr double kDoubtful = 0.72;          // of the points: fewer that agree, twice, while the first window fills
constexpr double kKeyParallax_rad = 0.012;  // median since the last keyframe
constexpr double kFewLeft = 0.6;            // of what the last keyframe had
constexpr double kLoose_px = 8;             // how far off a prediction may be
constexpr double kTurnFloor_rad = 1e-4;     // time stamps, the way between rows
constexpr double kRelocalise_s = 1.0;
constexpr double kDrift_radps = 0.003;  // of a gyroscope whose bias is known
constexpr double kStanding = 0.004;     // of the median depth, between two keyframes
constexpr double kDimBlur_px = 1.5;
constexpr double kSurprise_rad = 0.5;  // most that a frame turns otherwise than expected
constexpr double kOutlier = 4;         // sigmas, after an adjustment

Vector3d ray(const Vector2d& seen) { return Vector3d(seen.x(), seen.y(), 1).normalized(); }

}  // namespace

Odometry::Odometry(const Parameters& parameters, const CameraModel& camera)
    : p_(parameters), camera_(camera), tracker_(p_.corners), window_(kKeyframes), noise_px_(parameters.noise_px) {}

Motion Odometry::process(const Frame& frame) {
  Motion motion;
  predict(frame);
  if (relocalising_since_ns_) {
    relocalise(frame, motion);
  } else {
    follow(frame, expected_pose());
    undistort_tracks(frame);
    motion.tracked = static_cast<unsigned>(seen_.size());
    if (!have_reference_) {
      begin(frame, false);
    } else if (!started_) {
      const bool in_sight = start_or_turn(motion);
      if (started_)
        make_keyframe(frame);
      else if (!in_sight || static_cast<double>(seen_.size()) < kFewLeft * static_cast<double>(seen_at_keyframe_))
        begin(frame, false);
    } else if (!estimate_pose(expected_pose(), motion)) {
      relocalising_since_ns_ = frame.t_ns;
      if (doubts_ > 1) relocalisation_keyframe_.reset();
      relocalise(frame, motion);
    } else if (wants_keyframe()) {
      make_keyframe(frame);
    }
    seen_before_ = seen_.size();
  }
  motion.scale_group = group_;
  last_ns_ = frame.t_ns;
  return motion;
}

/// Something stands before the camera, or it is dark, or it turned too fast: for a while the camera is looked for from
/// where it was last well placed; then a new map begins.
void Odometry::relocalise(const Frame& frame, Motion& motion) {
  if (relocalisation_keyframe_) {
    tracker_ = relocalisation_keyframe_->tracker.snapshot();
    seen_ = relocalisation_keyframe_->seen;
    seen_lens_ = relocalisation_keyframe_->lens;
    const Isometry3d expected = pose_before() * isometry(expected_turn_, Vector3d::Zero());
    follow(frame, expected);
    undistort_tracks(frame);
    motion = Motion{.tracked = static_cast<unsigned>(seen_.size())};
    // A few points that agree before something that passes are no place.
    const size_t wanted = located_at_keyframe_ * 2 / 5;
    const Isometry3d T_k_c = T_k_c_, T_w_c = T_w_c_, last_step = last_step_;
    if (estimate_pose(expected, motion) && motion.inliers >= wanted) {
      relocalising_since_ns_.reset();
      return;
    }
    T_k_c_ = T_k_c, T_w_c_ = T_w_c, last_step_ = last_step;
  }
  motion = Motion{.tracked = motion.tracked};
  motion.failure = tracker_.mean_grey() < kDarkGrey ? FailureReason::too_dark : FailureReason::few_features;
  if (turn_) {
    motion.q_c0_c1 = turn_->q_c0_c1;
    motion.covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * turn_->sigma_rad * turn_->sigma_rad;
    motion.rotation_valid = true;
    T_k_c_.linear() = T_k_c_.linear() * turn_->q_c0_c1.toRotationMatrix();
  }
  if (!relocalisation_keyframe_ || static_cast<double>(frame.t_ns - *relocalising_since_ns_) * 1e-9 > kRelocalise_s)
    begin(frame, true);
}

/// How the camera turned since the last frame: by the gyroscope, or as between the two frames before.
void Odometry::predict(const Frame& frame) {
  step_s_ = have_reference_ ? static_cast<double>(frame.t_ns - last_ns_) * 1e-9 : 0;
  turn_.reset();
  if (have_reference_) turn_ = gyroscope_.between(last_ns_, frame.t_ns, bias_c_);
  expected_turn_ = turn_ ? turn_->q_c0_c1 : Quaterniond(last_step_.linear());
}

/// Where a corner is looked for: where the map says from the pose expected, or where the turn alone moves it.
Vector2d Odometry::expected_at(const Seen& s, const Isometry3d& T_expected) const {
  const auto found = window_.landmarks().find(s.track);
  if (started_ && found != window_.landmarks().end() && found->second.located) {
    const Eigen::Vector4d X = window_.point(found->second);
    const Vector3d y = T_expected.linear().transpose() * (X.head<3>() - X.w() * T_expected.translation());
    if (y.z() > 1e-3) return y.head<2>() / y.z();
  }
  const Vector3d y = expected_turn_.conjugate() * Vector3d(s.at.x(), s.at.y(), 1);
  return y.z() > 0.1 ? Vector2d(y.head<2>() / y.z()) : s.at;
}

void Odometry::follow(const Frame& frame, const Isometry3d& T_expected) {
  std::vector<cv::Point2f> expected;
  for (size_t i = 0; i < tracker_.tracks().size(); ++i) {
    // By how much the motion moves it, added to where it was: the same distortion on both sides.
    const Vector2d shift = camera_.project(expected_at(seen_[i], T_expected)) - seen_lens_.project(seen_[i].at);
    const cv::Point2f& pixel = tracker_.tracks()[i].pixel;
    expected.emplace_back(pixel.x + static_cast<float>(shift.x()), pixel.y + static_cast<float>(shift.y()));
  }
  if (cv::mean(frame.grey)[0] < kDimGrey) {  // by night the noise has more gradient than what is there
    cv::GaussianBlur(frame.grey, smooth_, {}, kDimBlur_px);
    return tracker_.follow(smooth_, expected);
  }
  tracker_.follow(frame.grey, expected);
}

/// Pixels to normalized coordinates, each as the middle row's time would have seen it had the camera only turned.
void Odometry::undistort_tracks(const Frame& frame) {
  std::vector<cv::Point2f> pixels;
  for (const auto& track : tracker_.tracks()) pixels.push_back(track.pixel);
  camera_.undistort(pixels, straight_);
  seen_lens_ = camera_;
  seen_.clear();
  const auto rate = frame.line_time_s > 0 ? gyroscope_.rate(frame.t_ns) : std::nullopt;
  for (size_t i = 0; i < pixels.size(); ++i) {
    Vector2d at(straight_[i].x, straight_[i].y);
    if (rate) {
      const double late_s = (static_cast<double>(pixels[i].y) - 0.5 * (frame.grey.rows - 1)) * frame.line_time_s;
      const Vector3d x = exp_rotation((*rate - bias_c_) * late_s) * Vector3d(at.x(), at.y(), 1);
      at = x.head<2>() / x.z();
    }
    seen_.push_back({tracker_.tracks()[i].id, at});
  }
}

Isometry3d Odometry::expected_pose() const {
  if (!started_) return T_w_c_;
  const double ahead = last_step_s_ > 0 ? step_s_ / last_step_s_ : 1;
  return pose_before() * isometry(expected_turn_, ahead * last_step_.translation());
}

/// Robust fit from where the camera is expected; where that fails, from wherever three points put it (RANSAC).
std::optional<FittedPose> Odometry::fit(const std::vector<PointSeen>& points, const Isometry3d& expected) {
  std::optional<RotationPrior> prior;
  const double blind_s =
      step_s_ + (relocalising_since_ns_ ? static_cast<double>(last_ns_ - *relocalising_since_ns_) * 1e-9 : 0.0);
  if (turn_) prior = RotationPrior{Quaterniond(expected.linear()), turn_->sigma_rad + kDrift_radps * blind_s};
  const auto good = [&](const std::optional<FittedPose>& pose) {
    return pose && pose->count >= kLeastPoints && 2 * static_cast<size_t>(pose->count) >= points.size();
  };
  const double loose = kLoose_px / camera_.focal();
  auto pose = fit_pose(points, expected, sigma(), loose, prior);
  if (good(pose)) return pose;
  if (const auto coarse = fit_pose(points, expected, kCoarse * sigma(), loose, prior); good(coarse)) {
    noise_px_ = std::min(kMostNoise_px, kCoarser * noise_px_);
    return coarse;
  }
  std::vector<cv::Point3d> world;
  std::vector<cv::Point2d> image;
  for (const PointSeen& point : points) {
    const Vector3d X = point.X_w.head<3>() / std::max(point.X_w.w(), 1e-6);
    world.emplace_back(X.x(), X.y(), X.z()), image.emplace_back(point.seen.x(), point.seen.y());
  }
  cv::Mat r, t;
  const cv::Matx33d K = cv::Matx33d::eye();
  if (!cv::solvePnPRansac(world, image, K, cv::noArray(), r, t, false, 200, static_cast<float>(4 * sigma()), 0.999,
                          cv::noArray(), cv::SOLVEPNP_AP3P))
    return pose;
  const Quaterniond q_c_w = exp_rotation(Vector3d(r.at<double>(0), r.at<double>(1), r.at<double>(2)));
  const Isometry3d T_c_w = isometry(q_c_w, Vector3d(t.at<double>(0), t.at<double>(1), t.at<double>(2)));
  const auto other = fit_pose(points, T_c_w.inverse(), sigma(), 0.3 * loose, prior);
  return other && (!pose || other->count > pose->count) ? other : pose;
}

bool Odometry::estimate_pose(const Isometry3d& T_expected, Motion& motion) {
  std::vector<PointSeen> points;
  std::vector<uint64_t> tracks;
  for (const Seen& s : seen_) {
    const auto found = window_.landmarks().find(s.track);
    if (found == window_.landmarks().end() || !found->second.located) continue;
    points.push_back({window_.point(found->second), s.at, window_.anchor(found->second), found->second.variance});
    tracks.push_back(s.track);
  }
  if (static_cast<int>(points.size()) < kLeastPoints) return false;
  const auto pose = fit(points, T_expected);
  if (!pose || pose->count < kLeastPoints || 4 * static_cast<size_t>(pose->count) < points.size()) return false;
  for (size_t i = 0; i < tracks.size(); ++i) {
    Landmark& landmark = window_.landmarks()[tracks[i]];
    landmark.misses = pose->inliers[i] ? 0 : landmark.misses + 1;
    if (landmark.misses > 2) window_.forget(tracks[i]);  // moves, or its depth is wrong: it may start anew
  }
  if (Eigen::AngleAxisd(T_expected.linear().transpose() * pose->T_w_c.linear()).angle() > kSurprise_rad) return false;
  // A start from little parallax may have been a false one: its map explains less from frame to frame.
  const bool doubtful = !window_.slid() && pose->count < kDoubtful * static_cast<double>(points.size());
  doubts_ = doubtful ? doubts_ + 1 : 0;
  if (doubts_ > 1) return false;
  learn_noise(points, *pose);
  motion.inliers = static_cast<unsigned>(pose->count);
  report(*pose, motion);
  return true;
}

/// How well corners are followed depends on the light: the median of what is left over, which for two normal components
/// of equal deviation is 1.18 deviations (Rayleigh).
void Odometry::learn_noise(const std::vector<PointSeen>& points, const FittedPose& pose) {
  std::vector<double> errors;
  for (const PointSeen& point : points) {
    const Vector3d y =
        pose.T_w_c.linear().transpose() * (point.X_w.head<3>() - point.X_w.w() * pose.T_w_c.translation());
    if (y.z() > 1e-9) errors.push_back((y.head<2>() / y.z() - point.seen).norm());
  }
  const double seen_px = std::clamp(median(errors) / 1.18 * camera_.focal(), kLeastNoise_px, kMostNoise_px);
  noise_px_ += kLearnNoise * (seen_px - noise_px_);
}

void Odometry::report(const FittedPose& pose, Motion& motion) {
  const Isometry3d T_before = pose_before();
  last_step_ = T_before.inverse() * pose.T_w_c;
  last_step_s_ = step_s_;
  motion.q_c0_c1 = Quaterniond(last_step_.linear()).normalized();
  motion.p_c0_c1 = last_step_.translation();
  motion.rotation_valid = motion.translation_valid = true;
  motion.state = Tracking::tracking;
  motion.failure = FailureReason::none;
  // Both poses stand by the map; what the gyroscope tied this turn to the last by, they share.
  Eigen::Matrix<double, 6, 6> to_c0 = Eigen::Matrix<double, 6, 6>::Zero(),
                              own = Eigen::Matrix<double, 6, 6>::Identity();
  to_c0.topLeftCorner<3, 3>() = last_step_.linear();
  to_c0.bottomRightCorner<3, 3>() = T_before.linear().transpose();
  if (turn_) own.topLeftCorner<3, 3>() -= pose.covariance.topLeftCorner<3, 3>() / std::pow(turn_->sigma_rad, 2);
  motion.covariance = to_c0 * (pose.covariance + own * last_covariance_ * own.transpose()) * to_c0.transpose();
  motion.covariance.diagonal().head<3>().array() += kTurnFloor_rad * kTurnFloor_rad;
  last_covariance_ = pose.covariance;
  T_w_c_ = pose.T_w_c;
  T_k_c_ = window_.keyframes().back().T_w_c.inverse() * T_w_c_;
}

/// Parallax enough to tell depths, or few of the last keyframe's points left.
bool Odometry::wants_keyframe() const {
  if (static_cast<double>(seen_.size()) < kFewLeft * static_cast<double>(seen_before_)) return false;  // see what comes
  const Keyframe& last = window_.keyframes().back();
  const Eigen::Matrix3d R_k_c = last.T_w_c.linear().transpose() * T_w_c_.linear();
  std::vector<double> parallax;
  size_t located = 0;
  const auto& landmarks = window_.landmarks();
  for (const Seen& s : seen_) {
    const auto found = landmarks.find(s.track);
    if (found == landmarks.end() || found->second.seen.empty()) continue;
    located += found->second.located;
    const Observation& o = found->second.seen.back();
    if (o.keyframe == last.id) parallax.push_back((R_k_c * ray(s.at) - ray(o.seen)).norm());
  }
  const double kept = static_cast<double>(parallax.size());
  if (median(parallax) > kKeyParallax_rad) return true;
  return kept < kFewLeft * static_cast<double>(seen_at_keyframe_) ||
         static_cast<double>(located) < kFewLeft * static_cast<double>(located_at_keyframe_);
}

void Odometry::make_keyframe(const Frame& frame) {
  // While the camera stands its keyframes would push those with a way out of the window, and the unit with them.
  const auto& keyframes = window_.keyframes();
  const size_t n = keyframes.size();
  if (n > 2 && (keyframes[n - 1].T_w_c.translation() - keyframes[n - 2].T_w_c.translation()).norm() <
                   kStanding * window_.depth_median())
    window_.drop_newest();
  const int64_t before_ns = window_.keyframes().back().t_ns;
  window_.add({0, frame.t_ns, T_w_c_, gyroscope_.between(before_ns, frame.t_ns, bias_c_), bias_c_});
  std::vector<uint64_t> alive;
  for (const Seen& s : seen_) {
    window_.observe(s.track, s.at);
    alive.push_back(s.track);
  }
  std::sort(alive.begin(), alive.end());
  window_.triangulate(kPointParallax_rad);
  failed_adjustments_ += adjust(window_, bias_c_, sigma()).failed;
  drop_outliers();
  window_.update_depth_variance(sigma());
  window_.slide();
  window_.forget_but(alive);
  T_w_c_ = window_.keyframes().back().T_w_c;
  T_k_c_.setIdentity();
  reference_ns_ = frame.t_ns;
  tracker_.refill(frame.mask);
  const size_t before = seen_.size();
  undistort_tracks(frame);
  for (size_t i = before; i < seen_.size(); ++i) window_.observe(seen_[i].track, seen_[i].at);
  relocalisation_keyframe_ = RelocalisationKeyframe{tracker_.snapshot(), seen_, seen_lens_};
  seen_at_keyframe_ = seen_.size();
  located_at_keyframe_ = 0;
  for (const Seen& s : seen_) located_at_keyframe_ += window_.landmarks()[s.track].located;
}

/// Observations that an adjustment left over are other things: what moves, what was followed wrongly.
void Odometry::drop_outliers() {
  const double bound = kOutlier * sigma();
  std::vector<uint64_t> gone;
  for (auto& [track, landmark] : window_.landmarks()) {
    if (!landmark.located) continue;
    const Eigen::Vector4d X = window_.point(landmark);
    int bad = 0;
    for (const Observation& o : landmark.seen) {
      const Isometry3d& T = window_.keyframe(o.keyframe).T_w_c;
      const Vector3d y = T.linear().transpose() * (X.head<3>() - X.w() * T.translation());
      bad += y.z() <= 0 || (y.head<2>() / y.z() - o.seen).norm() > bound;
    }
    if (bad > 1 || (bad == 1 && landmark.seen.size() < 4)) gone.push_back(track);
  }
  for (const uint64_t track : gone) window_.forget(track);
}

}  // namespace odograph::vo
