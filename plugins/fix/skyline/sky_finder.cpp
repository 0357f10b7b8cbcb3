// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/sky_finder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include <opencv2/imgproc.hpp>

namespace odograph::skyline {
SkyFinder::SkyFinder(const CameraModel& camera, cv::Size size) : camera_(camera), size_(size) {
  std::vector<cv::Point2d> corners;
  const auto w = static_cast<float>(size.width - 1), h = static_cast<float>(size.height - 1);
  camera_.undistort({{0, 0}, {w, 0}, {0, h}, {w, h}}, corners);
  widest_tan_ = 0;
  for (const auto& corner : corners) widest_tan_ = std::max(widest_tan_, std::hypot(corner.x, corner.y));
}

/// Segments the pixels with little more contrast than the noise of the sky at the zenith.
bool SkyFinder::segment(const cv::Mat& grey, const cv::Point& zenith) {
  cv::resize(grey, small_, {grey.cols / 2, grey.rows / 2}, 0, 0, cv::INTER_AREA);
  cv::blur(small_, small_, {3, 3});
  cv::erode(small_, low_, cv::Mat());
  cv::dilate(small_, high_, cv::Mat());
  cv::subtract(high_, low_, contrast_);
  const cv::Rect seed = cv::Rect(zenith.x - p_.seed_px, zenith.y - p_.seed_px, 2 * p_.seed_px + 1, 2 * p_.seed_px + 1) &
                        cv::Rect(0, 0, small_.cols, small_.rows);
  std::vector<uint8_t> values;
  for (int y = seed.y; y < seed.y + seed.height; ++y)
    values.insert(values.end(), contrast_.ptr(y) + seed.x, contrast_.ptr(y) + seed.x + seed.width);
  if (values.empty()) return false;
  const auto quantile = [&](double part) {
    const auto n = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + n, values.end());
    return values[static_cast<size_t>(n)];
  };
  const double noise = quantile(0.5);
  if (noise > p_.max_noise) return false;  // a roof, a tree or a lamp at the zenith
  const double most = std::max(p_.min_contrast, p_.contrast_by_noise * noise + 1);
  cv::threshold(contrast_, smooth_, most, 255, cv::THRESH_BINARY_INV);
  // The seed: the smoothest pixel of the patch.
  cv::Point start = zenith;
  uint8_t least = 255;
  for (int y = seed.y; y < seed.y + seed.height; ++y)
    for (int x = seed.x; x < seed.x + seed.width; ++x)
      if (contrast_.at<uint8_t>(y, x) < least) least = contrast_.at<uint8_t>(y, x), start = {x, y};
  if (smooth_.at<uint8_t>(start) == 0) return false;
  cv::Mat fill(small_.rows + 2, small_.cols + 2, CV_8UC1, cv::Scalar(255));
  cv::bitwise_not(smooth_, fill(cv::Rect(1, 1, small_.cols, small_.rows)));
  fill(cv::Rect(1, 1, small_.cols, small_.rows)).setTo(1, smooth_ == 0);
  fill.row(0).setTo(1), fill.row(fill.rows - 1).setTo(1), fill.col(0).setTo(1), fill.col(fill.cols - 1).setTo(1);
  const double step = std::max(p_.min_fill, p_.fill_by_noise * noise);
  cv::floodFill(small_, fill, start, cv::Scalar(0), nullptr, cv::Scalar::all(step), cv::Scalar::all(step),
                4 | cv::FLOODFILL_MASK_ONLY | (2 << 8));
  cv::compare(fill(cv::Rect(1, 1, small_.cols, small_.rows)), 2, mask_, cv::CMP_EQ);
  // Contrast and blur each extend one pixel to both sides of an edge.
  cv::dilate(mask_, mask_, cv::Mat(), {-1, -1}, 2);
  return true;
}

const std::vector<SkyEdge>& SkyFinder::find(const cv::Mat& grey, const Eigen::Vector3d& up_c,
                                            const Eigen::Vector3d& north_c) {
  edges_.clear();
  const auto pixel = [&](const Eigen::Vector3d& ray, cv::Point& at) {
    if (ray.z() <= p_.min_forward) return false;
    const Eigen::Vector2d normalized = ray.head<2>() / ray.z();
    if (normalized.norm() > widest_tan_) return false;
    const Eigen::Vector2d p = camera_.project(normalized);
    at = {static_cast<int>(std::floor(p.x() / 2 + 0.25)), static_cast<int>(std::floor(p.y() / 2 + 0.25))};
    return at.x >= 1 && at.y >= 1 && at.x < size_.width / 2 - 1 && at.y < size_.height / 2 - 1;
  };
  cv::Point zenith;
  if (!pixel(up_c, zenith) || !segment(grey, zenith)) return edges_;
  const Eigen::Vector3d north = (north_c - north_c.dot(up_c) * up_c).normalized();
  const Eigen::Vector3d east = north.cross(up_c);
  for (int j = 0; j < kDirections; ++j) {
    const double azimuth = (j + 0.5) * 2 * std::numbers::pi / kDirections;
    const Eigen::Vector3d horizontal = std::cos(azimuth) * north + std::sin(azimuth) * east;
    int dark = 0;
    double last_sky = 0;  // angle from the zenith
    bool open = false;
    for (double angle = 0; angle < p_.lowest_rad; angle += p_.step_rad) {
      cv::Point at;
      if (!pixel(std::cos(angle) * up_c + std::sin(angle) * horizontal, at)) {
        open = dark == 0;
        break;
      }
      if (mask_.at<uint8_t>(at))
        dark = 0, last_sky = angle;
      else if (++dark > p_.max_dark_px)
        break;  // too wide for a lamp, a wire or a bird
    }
    if (!open && dark == 0) continue;
    edges_.push_back({std::cos(last_sky) * up_c + std::sin(last_sky) * horizontal, open});
  }
  return edges_;
}

}  // namespace odograph::skyline
