// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/odometry.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "plugins/shared/camera/two_view.hpp"
#include "plugins/shared/median.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph::vo {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRayleighMedian = 1.18;  // ratio of the median of a Rayleigh distribution to its sigma

}  // namespace

Odometry::Odometry(const Parameters& parameters, const CameraModel& camera)
    : p_(parameters),
      camera_(camera),
      tracker_(p_.corners),
      gyroscope_(p_.gyroscope),
      bias_sigma_(p_.gyroscope.bias_sigma_radps),
      noise_px_(p_.noise.begin_px),
      window_(p_.keyframe) {}

Motion Odometry::process(const Frame& frame) {
  const Prediction predicted = predict(frame.t_ns);
  Outcome outcome = std::visit([&](auto& state) { return advance(std::move(state), frame, predicted); }, state_);
  state_ = std::move(outcome.next);
  last_ns_ = frame.t_ns;
  outcome.motion.scale_group = group_;
  return outcome.motion;
}

std::vector<TrackedCorner> Odometry::corners() const {
  std::vector<TrackedCorner> out;
  for (const SeenCorner& corner : seen_.corners) {
    const auto landmark = window_.landmarks().find(corner.track);
    const bool used =
        landmark != window_.landmarks().end() && landmark->second.triangulated && landmark->second.misses == 0;
    out.push_back({corner.track, corner.at.homogeneous(), Vector3d::Zero(), corner.pixel, used});
  }
  return out;
}

/// The first frame becomes the reference of the first map.
Odometry::Outcome Odometry::advance(AwaitingFrame, const Frame& frame, const Prediction& predicted) {
  follow(frame, track_.T_w_c, predicted.q_c0_c1);
  return {Motion{}, begin(frame)};
}

/// No map yet: reports rotations until there is parallax enough to start one.
Odometry::Outcome Odometry::advance(Initialising state, const Frame& frame, const Prediction& predicted) {
  follow(frame, track_.T_w_c, predicted.q_c0_c1);
  seen_ = undistort(frame);
  const Matches matches = matches_with_reference();
  Motion motion = rotation_by_gyroscope(predicted);
  const auto rotation = pure_rotation(matches.first, matches.second);
  if (!rotation) return {motion, begin(frame)};  // the reference is out of view
  const Quaterniond q_w_c(rotation->R_1_0.transpose());
  const double corner_sigma_rad = std::max(sigma(), rotation->median_residual_rad);
  update_bias(state, predicted, q_w_c, corner_sigma_rad);
  if (rotation->median_residual_rad > p_.start.min_parallax_ratio * p_.start.min_parallax_rad)
    if (const auto view = find_second_view(matches, q_w_c)) {
      motion = begin_map(*view, matches, state, predicted);
      MapTracking map;
      make_keyframe(frame, map);
      map.corners_before = seen_.corners.size();
      return {motion, std::move(map)};
    }
  motion.state = Tracking::degraded;
  motion.failure = FailureReason::no_parallax;
  motion.inliers = static_cast<unsigned>(matches.first.size());
  if (!motion.rotation_valid) {
    const double sigma_rad = corner_sigma_rad / std::sqrt(static_cast<double>(matches.first.size()));
    motion.q_c0_c1 = (Quaterniond(track_.T_w_c.linear()).conjugate() * q_w_c).normalized();
    motion.covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * sigma_rad * sigma_rad;
    motion.rotation_valid = true;
  }
  track_.T_w_c.linear() = track_.T_w_c.linear() * motion.q_c0_c1.toRotationMatrix();
  track_.last_step = isometry(motion.q_c0_c1, Vector3d::Zero());
  const bool few = static_cast<double>(seen_.corners.size()) <
                   p_.keyframe.few_left * static_cast<double>(state.corners_at_reference);
  return {motion, few ? begin(frame) : state};
}

/// Estimates the pose by the map; if that fails, relocalises.
Odometry::Outcome Odometry::advance(MapTracking map, const Frame& frame, const Prediction& predicted) {
  const Isometry3d T_expected = expected_pose(predicted);
  follow(frame, T_expected, predicted.q_c0_c1);
  seen_ = undistort(frame);
  const auto pose = estimate_pose(T_expected, predicted, predicted.step_s, map.suspect_frames);
  if (!pose) {
    if (map.suspect_frames > p_.pose.max_suspect_frames) map.keyframe.reset();
    Outcome outcome = advance(Relocalising{frame.t_ns, std::move(map)}, frame, predicted);
    if (auto* found = std::get_if<MapTracking>(&outcome.next)) found->corners_before = seen_.corners.size();
    if (auto* lost = std::get_if<Relocalising>(&outcome.next)) lost->map.corners_before = seen_.corners.size();
    return outcome;
  }
  const Motion motion = move_to(*pose, predicted);
  if (wants_keyframe(map)) make_keyframe(frame, map);
  map.corners_before = seen_.corners.size();
  return {motion, std::move(map)};
}

/// Relocalises from the last good keyframe; after a while a new map starts.
Odometry::Outcome Odometry::advance(Relocalising state, const Frame& frame, const Prediction& predicted) {
  MapTracking& map = state.map;
  if (map.keyframe) {
    tracker_ = map.keyframe->tracker.snapshot();
    seen_ = map.keyframe->seen;
    const Isometry3d T_expected = pose_before() * isometry(predicted.q_c0_c1, Vector3d::Zero());
    follow(frame, T_expected, predicted.q_c0_c1);
    seen_ = undistort(frame);
    const double unseen_s = predicted.step_s + seconds(last_ns_ - state.since_ns);
    const auto pose = estimate_pose(T_expected, predicted, unseen_s, map.suspect_frames);
    const auto wanted = static_cast<int>(p_.relocalise.min_inliers * static_cast<double>(map.triangulated_at_keyframe));
    if (pose && pose->count >= wanted) return {move_to(*pose, predicted), std::move(map)};
  }
  const Motion motion = rotation_by_gyroscope(predicted);
  if (motion.rotation_valid) track_.T_k_c.linear() = track_.T_k_c.linear() * motion.q_c0_c1.toRotationMatrix();
  if (!map.keyframe || seconds(frame.t_ns - state.since_ns) > p_.relocalise.patience_s)
    return {motion, begin_group(frame)};
  return {motion, std::move(state)};
}

/// Predicts the rotation since the last frame: by the gyroscope, or as between the previous two frames.
Prediction Odometry::predict(int64_t t_ns) const {
  Prediction predicted;
  if (!std::holds_alternative<AwaitingFrame>(state_)) {
    predicted.step_s = seconds(t_ns - last_ns_);
    predicted.gyro = gyroscope_.between(last_ns_, t_ns, bias_c_);
  }
  predicted.q_c0_c1 = predicted.gyro ? predicted.gyro->q_c0_c1 : Quaterniond(track_.last_step.linear());
  return predicted;
}

/// Constant-velocity prediction.
Isometry3d Odometry::expected_pose(const Prediction& predicted) const {
  const double ahead = track_.last_step_s > 0 ? predicted.step_s / track_.last_step_s : 1;
  return pose_before() * isometry(predicted.q_c0_c1, ahead * track_.last_step.translation());
}

/// Predicted position of a corner: by the map and the expected pose, or by the rotation alone.
Vector2d Odometry::expected_at(const SeenCorner& corner, const Isometry3d& T_expected,
                               const Quaterniond& q_c0_c1) const {
  const auto found = window_.landmarks().find(corner.track);
  if (found != window_.landmarks().end() && found->second.triangulated) {
    const Eigen::Vector4d X = window_.point(found->second);
    const Vector3d y = T_expected.linear().transpose() * (X.head<3>() - X.w() * T_expected.translation());
    if (y.z() > 1e-3) return y.head<2>() / y.z();
  }
  const Vector3d y = q_c0_c1.conjugate() * Vector3d(corner.at.x(), corner.at.y(), 1);
  return y.z() > 0.1 ? Vector2d(y.head<2>() / y.z()) : corner.at;
}

void Odometry::follow(const Frame& frame, const Isometry3d& T_expected, const Quaterniond& q_c0_c1) {
  std::vector<cv::Point2f> expected;
  for (size_t i = 0; i < tracker_.tracks().size(); ++i) {
    // Adds the predicted displacement to the previous position: the distortion is the same on both sides.
    const SeenCorner& before = seen_.corners[i];
    const Vector2d shift = camera_.project(expected_at(before, T_expected, q_c0_c1)) - seen_.lens.project(before.at);
    const cv::Point2f& pixel = tracker_.tracks()[i].pixel;
    expected.emplace_back(pixel.x + static_cast<float>(shift.x()), pixel.y + static_cast<float>(shift.y()));
  }
  content_ = content_of(frame.grey);
  if (!content_.has_content(p_.light.content)) return tracker_.skip();
  if (content_.mean_grey < p_.light.dim_grey) {
    cv::GaussianBlur(frame.grey, smooth_, {}, p_.light.dim_blur_px);
    return tracker_.follow(smooth_, expected);
  }
  tracker_.follow(frame.grey, expected);
}

/// Pixels to normalized coordinates: undistortion, and rolling-shutter compensation of the rotation.
SeenCorners Odometry::undistort(const Frame& frame) const {
  std::vector<cv::Point2f> pixels;
  std::vector<cv::Point2d> normalized;
  for (const auto& track : tracker_.tracks()) pixels.push_back(track.pixel);
  camera_.undistort(pixels, normalized);
  SeenCorners seen{{}, camera_};
  const auto rate = frame.line_time_s > 0 ? gyroscope_.rate(frame.t_ns) : std::nullopt;
  for (size_t i = 0; i < pixels.size(); ++i) {
    Vector2d at(normalized[i].x, normalized[i].y);
    if (rate) {
      const double late_s = (static_cast<double>(pixels[i].y) - 0.5 * (frame.grey.rows - 1)) * frame.line_time_s;
      const Vector3d x = exp_rotation((*rate - bias_c_) * late_s) * Vector3d(at.x(), at.y(), 1);
      at = x.head<2>() / x.z();
    }
    seen.corners.push_back({tracker_.tracks()[i].id, at, Vector2d(pixels[i].x, pixels[i].y)});
  }
  return seen;
}

/// The gyroscope's rotation, for frames without visual information.
Motion Odometry::rotation_by_gyroscope(const Prediction& predicted) const {
  Motion motion{.failure = dark_or_few_features(), .tracked = static_cast<unsigned>(seen_.corners.size())};
  if (!predicted.gyro) return motion;
  const double sigma_rad = predicted.gyro->sigma_rad;
  motion.q_c0_c1 = predicted.gyro->q_c0_c1;
  motion.covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * sigma_rad * sigma_rad;
  motion.rotation_valid = true;
  return motion;
}

FailureReason Odometry::dark_or_few_features() const {
  return content_.has_content(p_.light.content) ? FailureReason::few_features : FailureReason::too_dark;
}

/// The corners with a depth in the map.
std::vector<PointSeen> Odometry::points_seen(std::vector<uint64_t>& tracks) const {
  std::vector<PointSeen> points;
  for (const SeenCorner& corner : seen_.corners) {
    const auto found = window_.landmarks().find(corner.track);
    if (found == window_.landmarks().end() || !found->second.triangulated) continue;
    points.push_back({window_.point(found->second), corner.at, window_.anchor(found->second), found->second.variance});
    tracks.push_back(corner.track);
  }
  return points;
}

/// Robust fit from the expected pose; if that fails, from P3P with RANSAC.
std::optional<FittedPose> Odometry::fit(const std::vector<PointSeen>& points, const Isometry3d& T_expected,
                                        const Prediction& predicted, double unseen_s) {
  const PoseParameters& p = p_.pose;
  std::optional<RotationPrior> prior;
  if (predicted.gyro)
    prior = RotationPrior{Quaterniond(T_expected.linear()),
                          predicted.gyro->sigma_rad + p_.gyroscope.known_bias_drift_radps * unseen_s};
  const auto good = [&](const std::optional<FittedPose>& pose) {
    return pose && pose->count >= p.min_points && pose->count >= p.good_inliers * static_cast<double>(points.size());
  };
  const double loose = p.loose_px / camera_.focal();
  auto pose = fit_pose(points, T_expected, sigma(), loose, prior, p.fit);
  if (good(pose)) return pose;
  if (const auto coarse = fit_pose(points, T_expected, p.coarse * sigma(), loose, prior, p.fit); good(coarse)) {
    noise_px_ = std::min(p_.noise.max_px, p_.noise.coarser * noise_px_);
    return coarse;
  }
  const auto other = fit_by_ransac(points, prior);
  return other && (!pose || other->count > pose->count) ? other : pose;
}

std::optional<FittedPose> Odometry::fit_by_ransac(const std::vector<PointSeen>& points,
                                                  const std::optional<RotationPrior>& prior) const {
  const PoseParameters& p = p_.pose;
  std::vector<cv::Point3d> world;
  std::vector<cv::Point2d> image;
  for (const PointSeen& point : points) {
    const Vector3d X = point.X_w.head<3>() / std::max(point.X_w.w(), 1e-6);
    world.emplace_back(X.x(), X.y(), X.z()), image.emplace_back(point.seen.x(), point.seen.y());
  }
  cv::Mat r, t;
  const cv::Matx33d K = cv::Matx33d::eye();
  if (!cv::solvePnPRansac(world, image, K, cv::noArray(), r, t, false, p.ransac_trials,
                          static_cast<float>(p.ransac_sigmas * sigma()), p.ransac_confidence, cv::noArray(),
                          cv::SOLVEPNP_AP3P))
    return std::nullopt;
  const Quaterniond q_c_w = exp_rotation(Vector3d(r.at<double>(0), r.at<double>(1), r.at<double>(2)));
  const Isometry3d T_c_w = isometry(q_c_w, Vector3d(t.at<double>(0), t.at<double>(1), t.at<double>(2)));
  const double loose = p.loose_px / camera_.focal();
  return fit_pose(points, T_c_w.inverse(), sigma(), p.after_ransac * loose, prior, p.fit);
}

/// Pose of the camera by the map; nothing if too few points agree or the map is rejected.
std::optional<FittedPose> Odometry::estimate_pose(const Isometry3d& T_expected, const Prediction& predicted,
                                                  double unseen_s, int& suspect_frames) {
  const PoseParameters& p = p_.pose;
  std::vector<uint64_t> tracks;
  const std::vector<PointSeen> points = points_seen(tracks);
  const auto of_points = [&](double part) { return part * static_cast<double>(points.size()); };
  if (static_cast<int>(points.size()) < p.min_points) return std::nullopt;
  auto pose = fit(points, T_expected, predicted, unseen_s);
  if (!pose || pose->count < p.min_points || pose->count < of_points(p.min_inliers)) return std::nullopt;
  for (size_t i = 0; i < tracks.size(); ++i) {
    Landmark& landmark = window_.landmarks()[tracks[i]];
    landmark.misses = pose->inliers[i] ? 0 : landmark.misses + 1;
    if (landmark.misses > p.max_misses)
      window_.remove_landmark(tracks[i]);  // it moves or its depth is wrong; it may be triangulated again
  }
  if (Eigen::AngleAxisd(T_expected.linear().transpose() * pose->T_w_c.linear()).angle() > p.max_deviation_rad)
    return std::nullopt;
  // A start from little parallax may have been wrong: the map then explains less from frame to frame.
  const bool suspect = !window_.slid() && pose->count < of_points(p.suspect_inliers);
  suspect_frames = suspect ? suspect_frames + 1 : 0;
  if (suspect_frames > p.max_suspect_frames) return std::nullopt;
  update_noise(points, *pose);
  return pose;
}

/// Estimates the corner noise, which depends on the light, from the median residual.
void Odometry::update_noise(const std::vector<PointSeen>& points, const FittedPose& pose) {
  std::vector<double> errors;
  for (const PointSeen& point : points) {
    const Vector3d y =
        pose.T_w_c.linear().transpose() * (point.X_w.head<3>() - point.X_w.w() * pose.T_w_c.translation());
    if (y.z() > 1e-9) errors.push_back((y.head<2>() / y.z() - point.seen).norm());
  }
  const double seen_px =
      std::clamp(median(errors) / kRayleighMedian * camera_.focal(), p_.noise.min_px, p_.noise.max_px);
  noise_px_ += p_.noise.update_weight * (seen_px - noise_px_);
}

/// Motion to a pose given by the map, with its covariance.
Motion Odometry::move_to(const FittedPose& pose, const Prediction& predicted) {
  const Isometry3d T_before = pose_before();
  const Isometry3d step = T_before.inverse() * pose.T_w_c;
  Motion motion{.tracked = static_cast<unsigned>(seen_.corners.size()), .inliers = static_cast<unsigned>(pose.count)};
  motion.q_c0_c1 = Quaterniond(step.linear()).normalized();
  motion.p_c0_c1 = step.translation();
  motion.rotation_valid = motion.translation_valid = true;
  motion.state = Tracking::tracking;
  motion.failure = FailureReason::none;
  // Both poses refer to the same map. To the extent that the gyroscope determines the new rotation, both share the
  // error.
  Eigen::Matrix<double, 6, 6> to_c0 = Eigen::Matrix<double, 6, 6>::Zero(),
                              own = Eigen::Matrix<double, 6, 6>::Identity();
  to_c0.topLeftCorner<3, 3>() = step.linear();
  to_c0.bottomRightCorner<3, 3>() = T_before.linear().transpose();
  if (predicted.gyro)
    own.topLeftCorner<3, 3>() -= pose.covariance.topLeftCorner<3, 3>() / std::pow(predicted.gyro->sigma_rad, 2);
  motion.covariance = to_c0 * (pose.covariance + own * track_.covariance * own.transpose()) * to_c0.transpose();
  motion.covariance.diagonal().head<3>().array() += p_.pose.rotation_floor_rad * p_.pose.rotation_floor_rad;
  const Isometry3d T_k_c = window_.keyframes().back().T_w_c.inverse() * pose.T_w_c;
  track_ = {pose.T_w_c, T_k_c, step, predicted.step_s, pose.covariance};
  return motion;
}

}  // namespace odograph::vo
