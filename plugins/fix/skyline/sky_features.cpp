// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/sky_features.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace odograph::skyline {
namespace {

constexpr int kBarriers = 256;

/// The least value that so much of a histogram does not exceed.
int quantile(const std::array<int, 256>& histogram, double part) {
  int all = 0, sum = 0, value = 0;
  for (const int count : histogram) all += count;
  while (value < 255 && (sum += histogram[static_cast<size_t>(value)]) < part * all) ++value;
  return value;
}

/// Of grey values, so that 255 is four.
void logarithm(const cv::Mat& bytes, cv::Mat& to) {
  cv::Mat x;
  bytes.convertTo(x, CV_32F, 1, 1);
  cv::log(x, to);
  to *= 0.72;
}

double bent(const CameraModel& camera, double theta) {
  const auto k = [&](size_t i) { return i < camera.coefficients.size() ? camera.coefficients[i] : 0.0; };
  const double t2 = theta * theta;
  return theta * (1 + t2 * (k(0) + t2 * (k(1) + t2 * (k(2) + t2 * k(3)))));
}

}  // namespace

bool pixel_of(const CameraModel& camera, const Eigen::Vector3d& ray, double farthest_rad, Eigen::Vector2d& pixel) {
  const double across = ray.head<2>().norm(), theta = std::atan2(across, ray.z());
  if (theta > farthest_rad) return false;
  if (camera.distortion == CameraModel::Distortion::kannala_brandt) {
    const Eigen::Vector2d d =
        across > 1e-12 ? Eigen::Vector2d(ray.head<2>() * (bent(camera, theta) / across)) : Eigen::Vector2d::Zero();
    pixel = {camera.fx * d.x() + camera.cx, camera.fy * d.y() + camera.cy};
    return true;
  }
  if (ray.z() < 0.05) return false;
  pixel = camera.project(ray.head<2>() / ray.z());
  return true;
}

bool ray_of(const CameraModel& camera, const Eigen::Vector2d& pixel, double farthest_rad, Eigen::Vector3d& ray) {
  if (camera.distortion == CameraModel::Distortion::kannala_brandt) {
    const Eigen::Vector2d d((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
    const double r = d.norm();
    double theta = std::min(r, farthest_rad);
    for (int i = 0; i < 12; ++i) {
      constexpr double h = 1e-4;
      const double slope = (bent(camera, theta + h) - bent(camera, theta - h)) / (2 * h);
      if (slope < 0.05) return false;  // the polynomial turns back
      theta -= (bent(camera, theta) - r) / slope;
      if (!(theta >= 0 && theta < 2.5)) return false;
    }
    if (theta > farthest_rad || std::abs(bent(camera, theta) - r) > 1e-6) return false;
    ray << (r > 1e-12 ? Eigen::Vector2d(d * (std::sin(theta) / r)) : Eigen::Vector2d::Zero()), std::cos(theta);
    return true;
  }
  std::vector<cv::Point2d> normalized;
  camera.undistort({{static_cast<float>(pixel.x()), static_cast<float>(pixel.y())}}, normalized);
  ray = Eigen::Vector3d(normalized[0].x, normalized[0].y, 1).normalized();
  return std::acos(ray.z()) <= farthest_rad;
}

SkyFeatureMaker::SkyFeatureMaker(const CameraModel& camera, cv::Size size, double farthest_rad)
    : size_(size), scale_(std::max(1.0, std::max(size.width, size.height) / double(SkyFeatures::kLonger_px))) {
  small_ = {static_cast<int>(std::lround(size.width / scale_)), static_cast<int>(std::lround(size.height / scale_))};
  lens_valid_ = cv::Mat(small_, CV_8U, cv::Scalar(0));
  for (int y = 0; y < small_.height; ++y)
    for (int x = 0; x < small_.width; ++x) {
      const Eigen::Vector2d pixel((x + 0.5) * scale_ - 0.5, (y + 0.5) * scale_ - 0.5);
      Eigen::Vector3d ray(0, 0, 1);
      if (ray_of(camera, pixel, farthest_rad, ray)) lens_valid_.at<uint8_t>(y, x) = 255;
      rays_.push_back(ray.cast<float>());
    }
  queue_.resize(kBarriers);
}

/// The weakest barrier on any path from the seeds to each pixel: a flood fill at all thresholds at once.
void SkyFeatureMaker::flood(const cv::Mat& contrast, const std::vector<int>& seeds) {
  level_.create(contrast.size(), CV_8U);
  level_.setTo(255);
  auto* horizontal = level_.ptr<uint8_t>();
  const auto* barrier = contrast.ptr<uint8_t>();
  for (auto& bucket : queue_) bucket.clear();
  for (const int seed : seeds) horizontal[seed] = barrier[seed], queue_[barrier[seed]].push_back(seed);
  const int columns = contrast.cols, cells = static_cast<int>(contrast.total());
  for (size_t b = 0; b < queue_.size(); ++b)
    for (size_t i = 0; i < queue_[b].size(); ++i) {
      const int at = queue_[b][i];
      if (horizontal[at] != b) continue;
      const int x = at % columns;
      const auto visit = [&](int next) {
        const uint8_t to = std::max(static_cast<uint8_t>(b), barrier[next]);
        if (to >= horizontal[next]) return;
        horizontal[next] = to;
        queue_[to].push_back(next);
      };
      if (x > 0) visit(at - 1);
      if (x + 1 < columns) visit(at + 1);
      if (at >= columns) visit(at - columns);
      if (at + columns < cells) visit(at + columns);
    }
}

/// The picture made small, what of it is valid, and its contrast with what is next to each pixel.
void SkyFeatureMaker::prepare(const cv::Mat& grey, const cv::Mat& mask, SkyFeatures& out) {
  cv::resize(grey, image_, small_, 0, 0, cv::INTER_AREA);
  out.scale = scale_;
  lens_valid_.copyTo(out.valid);
  if (!mask.empty()) {
    cv::resize(mask, low_, small_, 0, 0, cv::INTER_NEAREST);
    out.valid.setTo(0, low_ == 0);
  }
  cv::blur(image_, blurred_, {3, 3});
  cv::erode(blurred_, low_, cv::Mat());
  cv::dilate(blurred_, high_, cv::Mat());
  cv::subtract(high_, low_, contrast_);
  contrast_.setTo(255, out.valid == 0);  // the rim of the lens is no path
}

/// What lies nearest to the zenith is asked what the sky looks like.
std::optional<SkyFeatureMaker::Reference> SkyFeatureMaker::find_reference(const std::vector<float>& height,
                                                                          const cv::Mat& valid) const {
  const auto n = static_cast<int>(height.size());
  std::vector<float> sorted;
  for (int i = 0; i < n; ++i)
    if (valid.data[i]) sorted.push_back(height[static_cast<size_t>(i)]);
  if (sorted.size() < p_.min_valid) return std::nullopt;
  const auto nth = static_cast<std::ptrdiff_t>((1 - p_.part) * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), sorted.begin() + nth, sorted.end());
  const float min_height = sorted[static_cast<size_t>(nth)];
  std::vector<int> high;
  std::array<int, 256> of_contrast{};
  for (int i = 0; i < n; ++i)
    if (valid.data[i] && height[static_cast<size_t>(i)] >= min_height)
      high.push_back(i), ++of_contrast[contrast_.data[i]];
  // The smoother half of it, and of that the brighter part: sky is brighter than what stands in it.
  Reference reference;
  reference.noise = quantile(of_contrast, p_.noise_quantile);
  std::array<int, 256> of_grey{};
  for (const int i : high)
    if (contrast_.data[i] <= reference.noise) ++of_grey[blurred_.data[i]];
  reference.sky = quantile(of_grey, p_.sky_quantile);
  const int least = quantile(of_grey, p_.seed_quantile);
  for (const int i : high)
    if (contrast_.data[i] <= reference.noise && blurred_.data[i] >= least) reference.seeds.push_back(i);
  const bool enough = static_cast<double>(reference.seeds.size()) >= p_.min_part * static_cast<double>(sorted.size());
  return enough ? std::optional(std::move(reference)) : std::nullopt;
}

/// Mean and logarithm of the variance over a square: from 0 for smooth to 3 for leaves.
void SkyFeatureMaker::spread(int side, cv::Mat& mean, cv::Mat& to) {
  cv::blur(float_, mean, {side, side});
  cv::sqrBoxFilter(float_, square_, CV_32F, {side, side});
  cv::Mat variance = square_ - mean.mul(mean);
  cv::max(variance, 0, variance);
  variance += 1;
  cv::log(variance, to);
  to *= 0.36;  // half of 1 / log 4
}

bool SkyFeatureMaker::make(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Vector3d& up_c, SkyFeatures& out,
                           bool around) {
  prepare(grey, mask, out);
  std::vector<float> height;  // sine of the elevation
  const Eigen::Vector3f up = up_c.cast<float>();
  for (const Eigen::Vector3f& ray : rays_) height.push_back(ray.dot(up));
  const auto reference = find_reference(height, out.valid);
  if (!reference) return false;
  flood(contrast_, reference->seeds);
  image_.convertTo(float_, CV_32F);
  const auto sky = static_cast<float>(reference->sky);
  float_.convertTo(out.channels[0], CV_32F, 1 / 128.0, -1);
  float_.convertTo(out.channels[1], CV_32F, 1 / 64.0, -sky / 64.0);
  cv::Mat mean5;
  spread(5, mean5, out.channels[2]);
  if (around)
    spread(17, mean_, out.channels[3]);
  else
    cv::blur(float_, mean_, {17, 17});
  logarithm(contrast_, out.channels[4]);
  logarithm(level_, out.channels[5]);
  cv::Mat(image_.size(), CV_32F, height.data()).copyTo(out.channels[6]);
  cv::erode(blurred_, low_, cv::Mat(), {-1, -1}, 4);
  low_.convertTo(out.channels[7], CV_32F, 1 / 64.0, -sky / 64.0);
  cv::Mat against = (float_ - mean_) / 32;
  against.copyTo(out.channels[8]);
  out.channels[9].create(image_.size(), CV_32F);
  out.channels[9].setTo(0.72 * std::log(1.0 + reference->noise));
  if (!around) return true;
  // What is around: a wall has windows, and each of them has a barrier of its own; the sky has none.
  cv::blur(out.channels[5], out.channels[10], {25, 25});
  cv::blur(out.channels[5], out.channels[11], {9, 9});
  cv::Mat mean33;
  spread(33, mean33, out.channels[12]);
  cv::erode(low_, low_, cv::Mat(), {-1, -1}, 8);
  low_.convertTo(out.channels[13], CV_32F, 1 / 64.0, -sky / 64.0);
  return true;
}

}  // namespace odograph::skyline
