// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/corners.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "plugins/shared/median.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph::vio {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<Vector3d> rays_of(const std::vector<cv::Point2f>& pixels, const CameraModel& lens) {
  std::vector<cv::Point2d> normalized;
  lens.undistort(pixels, normalized);
  std::vector<Vector3d> rays;
  rays.reserve(pixels.size());
  for (const cv::Point2d& p : normalized) rays.emplace_back(p.x, p.y, 1);
  return rays;
}

}  // namespace

const FrameCorners& GuidedCorners::follow(const cv::Mat& grey, const cv::Mat& mask, int64_t t_ns, double dt_s,
                                          const Eigen::Quaterniond& q_c0_c1, const Vector2d& shift_px,
                                          const CameraModel& lens) {
  const CameraModel before = before_.empty() ? lens : lens_;
  lens_ = lens;
  content_ = content_of(grey);
  if (content_.mean_grey < p_.dim_grey)
    cv::GaussianBlur(grey, smooth_, {}, p_.dim_blur_px);
  else
    grey.copyTo(smooth_);
  corners_.t_ns = t_ns;
  corners_.corners.clear();
  if (too_dark()) {
    keep_only(std::vector<char>(tracks_.size(), 0));
    before_.clear();
    followed_ = 0;
    return corners_;
  }
  cv::buildOpticalFlowPyramid(smooth_, now_, {p_.window_px, p_.window_px}, p_.levels, true, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, false);
  if (!before_.empty() && !tracks_.empty()) {
    std::vector<cv::Point2f> to;
    predict(q_c0_c1, shift_px, before, dt_s, to);
    const double ratio = brightness_ratio(to);
    track_forward(std::abs(ratio - 1) > p_.light_change ? correct_brightness(ratio) : now_, to);
    refine_by_patch(now_[0], q_c0_c1);
    drop_outliers(q_c0_c1, shift_px);
    for (Track& t : tracks_)
      t.parallax = dt_s > 0 ? Vector2d((Vector2d(t.pixel.x, t.pixel.y) - t.turned) / dt_s) : Vector2d(0, 0);
  }
  std::swap(before_, now_);
  followed_ = tracks_.size();
  if (static_cast<double>(followed_) < p_.refill_below * p_.max_corners) refill(smooth_, mask);
  for (const Track& t : tracks_) corners_.corners.push_back({t.id, Vector2d(t.pixel.x, t.pixel.y), t.pixel.y});
  return corners_;
}

void GuidedCorners::keep_only(const std::vector<char>& keep) {
  size_t n = 0;
  for (size_t i = 0; i < tracks_.size(); ++i)
    if (keep[i])
      tracks_[n++] = tracks_[i];
    else
      free_patches_.push_back(tracks_[i].patch);
  tracks_.resize(n);
}

void GuidedCorners::predict(const Eigen::Quaterniond& q_c0_c1, const Vector2d& shift_px, const CameraModel& before,
                            double dt_s, std::vector<cv::Point2f>& to) {
  std::vector<cv::Point2f> from;
  for (const Track& t : tracks_) from.push_back(t.pixel);
  const auto rays = rays_of(from, before);
  to.clear();
  for (size_t i = 0; i < tracks_.size(); ++i) {
    Track& t = tracks_[i];
    t.ray = rays[i];
    t.turned = Vector2d(t.pixel.x, t.pixel.y) + shift_px;
    const Vector3d y = q_c0_c1.conjugate() * t.ray;
    const Vector3d& seen = y.z() > 0.1 ? y : t.ray;
    t.turned += lens_.project(seen.head<2>() / seen.z()) - before.project(t.ray.head<2>());
    const Vector2d guess = t.turned + dt_s * t.parallax;
    to.emplace_back(static_cast<float>(guess.x()), static_cast<float>(guess.y()));
  }
}

/// Median ratio of the brightness around the corners to that in the previous frame. One if there is nothing to compare.
double GuidedCorners::brightness_ratio(const std::vector<cv::Point2f>& to) const {
  const int half = p_.light_px / 2;
  const auto mean_at = [&](const cv::Mat& picture, const cv::Point2f& at) {
    const cv::Rect window(cvRound(at.x) - half, cvRound(at.y) - half, p_.light_px, p_.light_px);
    const cv::Rect whole(0, 0, picture.cols, picture.rows);
    return (window & whole) == window ? cv::mean(picture(window))[0] : 0.0;
  };
  std::vector<double> ratios;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const double was = mean_at(before_[0], tracks_[i].pixel), is = mean_at(now_[0], to[i]);
    if (was > p_.content.dark_grey && is > p_.content.dark_grey) ratios.push_back(is / was);
  }
  return ratios.size() < p_.min_for_ransac ? 1.0 : median(ratios);
}

/// The present picture with the brightness of the previous one.
const GuidedCorners::Pyramid& GuidedCorners::correct_brightness(double ratio) {
  cv::Mat picture;
  smooth_.convertTo(picture, CV_8U, 1 / ratio);
  cv::buildOpticalFlowPyramid(picture, brightness_corrected_, {p_.window_px, p_.window_px}, p_.levels, true,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
  return brightness_corrected_;
}

void GuidedCorners::track_forward(const Pyramid& now, std::vector<cv::Point2f>& to) {
  std::vector<cv::Point2f> from;
  for (const Track& t : tracks_) from.push_back(t.pixel);
  const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, p_.settled_px);
  const cv::Size window(p_.window_px, p_.window_px);
  std::vector<cv::Point2f> back = from;
  std::vector<uchar> found, found_back;
  cv::calcOpticalFlowPyrLK(before_, now, from, to, found, cv::noArray(), window, p_.levels, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  cv::calcOpticalFlowPyrLK(now, before_, to, back, found_back, cv::noArray(), window, 1, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  const cv::Rect2f inside(1, 1, static_cast<float>(now[0].cols - 2), static_cast<float>(now[0].rows - 2));
  std::vector<char> keep(tracks_.size());
  for (size_t i = 0; i < tracks_.size(); ++i) {
    keep[i] = found[i] && found_back[i] && inside.contains(to[i]) && cv::norm(from[i] - back[i]) < p_.back_px;
    tracks_[i].pixel = to[i];
  }
  keep_only(keep);
}

/// Frame-to-frame tracking accumulates errors; matching the patch of the first picture does not.
void GuidedCorners::refine_by_patch(const cv::Mat& picture, const Eigen::Quaterniond& q_c0_c1) {
  const Eigen::Matrix2d roll = Eigen::Rotation2Dd(-log_rotation(q_c0_c1).z()).toRotationMatrix();
  std::vector<char> keep(tracks_.size(), 1);
  for (size_t i = 0; i < tracks_.size(); ++i) {
    Track& t = tracks_[i];
    const Vector2d pixel(t.pixel.x, t.pixel.y);
    std::optional<Patch::Match> match;
    if (t.known) match = patches_[t.patch].find(picture, {pixel, roll * t.map.A}, p_.patch);
    const double growth = match ? std::abs(match->map.A.determinant()) : 0;
    if (match && (match->map.at - pixel).norm() < p_.reference_px && growth > p_.min_growth && growth < p_.max_growth) {
      t.map = match->map;
      t.pixel = {static_cast<float>(t.map.at.x()), static_cast<float>(t.map.at.y())};
      // A corner formed by an edge and something that moves behind it is not a point in space.
      keep[i] = match->difference < p_.reference_error;
    } else {
      t.map = {pixel, Eigen::Matrix2d::Identity()};
      t.known = patches_[t.patch].store(picture, pixel, p_.patch);
    }
  }
  keep_only(keep);
}

void GuidedCorners::drop_outliers(const Eigen::Quaterniond& q_c0_c1, const Vector2d& shift_px) {
  if (tracks_.size() < p_.min_for_ransac) return;
  std::vector<cv::Point2f> pixels;
  const cv::Point2f shift(static_cast<float>(shift_px.x()), static_cast<float>(shift_px.y()));
  for (const Track& t : tracks_) pixels.push_back(t.pixel - shift);
  const auto rays = rays_of(pixels, lens_);
  std::vector<Vector3d> normals(tracks_.size());
  for (size_t i = 0; i < tracks_.size(); ++i)
    normals[i] = (q_c0_c1.conjugate() * tracks_[i].ray).normalized().cross(rays[i].normalized());
  const double bound = p_.epipolar_px / lens_.focal();
  std::vector<char> best, inliers(tracks_.size());
  size_t most = 0;
  uint32_t random = 12345;  // fixed seed: the same draws in every frame
  const auto draw = [&] { return (random = random * 1664525u + 1013904223u) >> 8; };
  for (int trial = 0; trial < p_.trials; ++trial) {
    const size_t i = draw() % tracks_.size(), j = draw() % tracks_.size();
    const Vector3d t = normals[i].cross(normals[j]);
    if (i == j || t.norm() < 1e-12) continue;
    const Vector3d direction = t.normalized();
    size_t count = 0;
    for (size_t k = 0; k < tracks_.size(); ++k) count += inliers[k] = std::abs(normals[k].dot(direction)) < bound;
    if (count > most) most = count, best = inliers;
  }
  if (static_cast<double>(most) > p_.min_inliers * static_cast<double>(tracks_.size())) keep_only(best);
}

void GuidedCorners::refill(const cv::Mat& picture, const cv::Mat& mask) {
  const int columns = picture.cols / p_.cell_px + 1, rows = picture.rows / p_.cell_px + 1;
  std::vector<char> taken(static_cast<size_t>(columns * rows), 0);
  const auto cell = [&](const cv::Point2f& p) {
    return static_cast<size_t>(static_cast<int>(p.y) / p_.cell_px * columns + static_cast<int>(p.x) / p_.cell_px);
  };
  for (const Track& t : tracks_) taken[cell(t.pixel)] = 1;
  const auto wanted = static_cast<size_t>(std::max(0, p_.max_corners - static_cast<int>(tracks_.size())));
  std::vector<cv::Point2f> corners, chosen;
  // At half resolution: a quarter of the work, and corners that exist at both scales are tracked better.
  constexpr size_t kHalf = 2;           // the pyramid alternates pictures and their derivatives
  if (before_.size() <= kHalf) return;  // the picture is smaller than the window
  const cv::Mat& half = before_[kHalf];
  cv::Mat half_mask;
  if (!mask.empty()) cv::resize(mask, half_mask, half.size(), 0, 0, cv::INTER_NEAREST);
  cv::goodFeaturesToTrack(half, corners, 4 * p_.max_corners, p_.quality, p_.min_distance_px / 2, half_mask,
                          p_.block_px);
  for (cv::Point2f& corner : corners) corner *= 2;
  for (const cv::Point2f& corner : corners) {
    if (chosen.size() >= wanted) break;
    if (std::exchange(taken[cell(corner)], 1)) continue;
    chosen.push_back(corner);
  }
  if (chosen.empty()) return;
  cv::cornerSubPix(picture, chosen, {4, 4}, {-1, -1}, {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.02});
  for (const cv::Point2f& corner : chosen) {
    Track t;
    t.id = next_id_++, t.pixel = corner;
    t.map.at = {corner.x, corner.y};
    if (free_patches_.empty()) {
      t.patch = patches_.size();
      patches_.emplace_back();
    } else {
      t.patch = free_patches_.back();
      free_patches_.pop_back();
    }
    t.known = patches_[t.patch].store(picture, t.map.at, p_.patch);
    tracks_.push_back(t);
  }
}

}  // namespace odograph::vio
