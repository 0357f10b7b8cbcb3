// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/corners.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace odograph::vio {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr size_t kLeastForRansac = 10;
constexpr double kLeastInliers = 0.4;  // fewer: it is the rotation that is wrong, nobody is taken out

std::vector<Vector3d> rays_of(const std::vector<cv::Point2f>& pixels, const CameraModel& lens) {
  std::vector<cv::Point2d> straight;
  lens.undistort(pixels, straight);
  std::vector<Vector3d> rays;
  rays.reserve(pixels.size());
  for (const cv::Point2d& p : straight) rays.emplace_back(p.x, p.y, 1);
  return rays;
}

}  // namespace

const FrameCorners& GuidedCorners::follow(const cv::Mat& grey, const cv::Mat& mask, int64_t t_ns, double dt_s,
                                          const Eigen::Quaterniond& q_c0_c1, const CameraModel& lens) {
  std::vector<cv::Point2f> before, expected;
  for (const auto& track : tracker_.tracks()) before.push_back(track.pixel);
  std::vector<Vector2d> turned(before.size());
  const auto rays = rays_of(before, lens);
  for (size_t i = 0; i < before.size(); ++i) {
    const Vector3d y = q_c0_c1.conjugate() * rays[i];
    const Vector2d here(before[i].x, before[i].y);
    turned[i] = here;
    if (y.z() > 0.1) turned[i] += lens.project(y.head<2>() / y.z()) - lens.project(rays[i].head<2>());
    const auto known = parallax_px_s_.find(tracker_.tracks()[i].id);
    const Vector2d guess =
        turned[i] + (known == parallax_px_s_.end() ? Vector2d(0, 0) : Vector2d(dt_s * known->second));
    expected.emplace_back(static_cast<float>(guess.x()), static_cast<float>(guess.y()));
  }
  std::map<uint64_t, Vector2d> turned_of;
  std::map<uint64_t, Vector3d> ray_of;
  for (size_t i = 0; i < before.size(); ++i) {
    turned_of[tracker_.tracks()[i].id] = turned[i];
    ray_of[tracker_.tracks()[i].id] = rays[i];
  }
  if (cv::mean(grey)[0] < p_.dim_grey) {
    cv::GaussianBlur(grey, smooth_, {}, p_.dim_blur_px);
    tracker_.follow(smooth_, expected);
  } else {
    tracker_.follow(grey, expected);
  }
  // Two-point RANSAC over what is still followed.
  const auto& tracks = tracker_.tracks();
  std::vector<cv::Point2f> now;
  for (const auto& track : tracks) now.push_back(track.pixel);
  const auto rays_now = rays_of(now, lens);
  std::vector<Vector3d> normals(tracks.size());
  for (size_t i = 0; i < tracks.size(); ++i)
    normals[i] = (q_c0_c1.conjugate() * ray_of[tracks[i].id]).normalized().cross(rays_now[i].normalized());
  if (tracks.size() >= kLeastForRansac) {
    const double bound = p_.epipolar_px / lens.focal();
    std::vector<char> best;
    size_t most = 0;
    uint32_t seed = 12345;
    const auto draw = [&] { return (seed = seed * 1664525u + 1013904223u) >> 8; };
    for (int trial = 0; trial < p_.trials; ++trial) {
      const size_t i = draw() % tracks.size(), j = draw() % tracks.size();
      const Vector3d t = normals[i].cross(normals[j]);
      if (i == j || t.norm() < 1e-12) continue;
      const Vector3d direction = t.normalized();
      std::vector<char> inliers(tracks.size());
      size_t count = 0;
      for (size_t k = 0; k < tracks.size(); ++k) count += inliers[k] = std::abs(normals[k].dot(direction)) < bound;
      if (count > most) most = count, best = inliers;
    }
    if (static_cast<double>(most) > kLeastInliers * static_cast<double>(tracks.size())) tracker_.drop(best);
  }
  parallax_px_s_.clear();
  for (const auto& track : tracker_.tracks())
    if (dt_s > 0) parallax_px_s_[track.id] = (Vector2d(track.pixel.x, track.pixel.y) - turned_of[track.id]) / dt_s;
  followed_ = tracker_.tracks().size();
  if (static_cast<double>(followed_) < p_.refill_below * p_.tracker.most) tracker_.refill(mask);
  corners_.t_ns = t_ns;
  corners_.corners.clear();
  for (const auto& track : tracker_.tracks())
    corners_.corners.push_back({track.id, Vector2d(track.pixel.x, track.pixel.y)});
  std::sort(corners_.corners.begin(), corners_.corners.end(),
            [](const Corner& a, const Corner& b) { return a.track < b.track; });
  return corners_;
}

}  // namespace odograph::vio
