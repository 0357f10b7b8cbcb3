// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/seen_skyline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sdk/math/rotation.hpp"

namespace odograph::skyline {
namespace {

constexpr double kFullCircle_rad = 2 * std::numbers::pi;
constexpr SeenSkyline::Parameters kParameters;

}  // namespace

Eigen::Quaterniond Guess::rotation() const {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * exp_rotation(Eigen::Vector3d(tilt_north, tilt_east, 0));
}

void SeenSkyline::set(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c) {
  rays_.clear();
  lowest_ = 0.5 * std::numbers::pi, total_weight_ = 0;
  for (const SkyEdge& e : edges) {
    const Eigen::Vector3d u = q_n_c * e.ray_c;
    const double horizontal = std::hypot(u.x(), u.y());
    Ray ray{};
    ray.azimuth = std::atan2(u.y(), u.x()), ray.elevation = std::atan2(-u.z(), horizontal);
    ray.slope = std::clamp(-u.z() / std::max(horizontal, 1e-9), -kParameters.steepest, kParameters.steepest);
    ray.cosine = std::cos(ray.azimuth), ray.sine = std::sin(ray.azimuth);
    ray.below = e.open ? 0 : 1, ray.above = e.above ? 0 : 1;
    ray.weight = kParameters.min_weight + (1 - kParameters.min_weight) * e.weight;
    total_weight_ += ray.weight;
    rays_.push_back(ray);
    lowest_ = std::min(lowest_, ray.elevation);
  }
  turned_.clear();
  turned_weight_ = 1e-9f;
  constexpr int n = Horizon::kDirections;
  for (size_t i = 0; i < rays_.size(); i += kParameters.stride) {
    const Ray& ray = rays_[i];
    const int direction = static_cast<int>(std::floor((ray.azimuth / kFullCircle_rad + 1) * n)) % n;
    turned_.push_back({direction, static_cast<float>(ray.elevation), static_cast<float>(ray.below),
                       static_cast<float>(ray.above), static_cast<float>(ray.weight)});
    turned_weight_ += turned_.back().weight;
  }
}

/// The model's skyline minus the observed one; the inclination is to first order.
inline double SeenSkyline::difference(const Ray& ray, const Horizon& model, const Guess& g) const {
  const double up = g.tilt_east * ray.cosine - g.tilt_north * ray.sine;
  const double round = g.yaw + ray.slope * (g.tilt_north * ray.cosine + g.tilt_east * ray.sine);
  const double yaw_steps = (ray.azimuth + round) * (1 / kFullCircle_rad) + 2;  // positive
  const auto j = static_cast<size_t>((yaw_steps - static_cast<int>(yaw_steps)) * Horizon::kDirections);
  const double above = static_cast<double>(model.elevation[j]) - ray.elevation - up;
  return std::max(above * ray.above, -above * ray.below);
}

void SeenSkyline::add_loss(const Horizon& model, const Guess& guess, double max_rad, Sum& sum) const {
  for (const Ray& ray : rays_) {
    sum.value += ray.weight * std::min(max_rad, difference(ray, model, guess));
    sum.weight += ray.weight;
  }
}

BinarySky SeenSkyline::image(const Guess& g) const {
  BinarySky image;
  for (const Ray& ray : rays_) {
    const double up = g.tilt_east * ray.cosine - g.tilt_north * ray.sine;
    const double round = g.yaw + ray.slope * (g.tilt_north * ray.cosine + g.tilt_east * ray.sine);
    image.add(ray.azimuth + round, ray.elevation + up, ray.below == 0, ray.above == 0);
  }
  return image;
}

std::pair<double, double> SeenSkyline::azimuths() const {
  std::vector<double> all;
  for (const Ray& ray : rays_) all.push_back(ray.azimuth);
  if (all.empty()) return {0, kFullCircle_rad};
  std::sort(all.begin(), all.end());
  // The directions start after the widest gap.
  double widest = all.front() + kFullCircle_rad - all.back();
  std::pair<double, double> ends = {all.front(), all.back()};
  for (size_t i = 1; i < all.size(); ++i)
    if (const double gap = all[i] - all[i - 1]; gap > widest)
      widest = gap, ends = {all[i], all[i - 1] + kFullCircle_rad};
  return ends;
}

std::vector<SeenSkyline::Summary> SeenSkyline::summary() const {
  std::vector<Summary> all;
  for (const Ray& ray : rays_) all.push_back({ray.azimuth, ray.elevation, ray.above, ray.below});
  return all;
}

double SeenSkyline::turned_loss(const Twice& twice, int half_degrees, double max_rad) const {
  constexpr int n = Horizon::kDirections;
  const float* model = twice.data() + ((half_degrees % n) + n) % n;
  const auto most = static_cast<float>(max_rad);
  float sum = 0;
  for (const Turned& t : turned_) {
    const float above = model[t.direction] - t.elevation;
    sum += t.weight * std::min(most, std::max(above * t.above, -above * t.below));
  }
  return static_cast<double>(sum / turned_weight_);
}

void SeenSkyline::add_agreement(const Horizon& model, const Guess& guess, double bound_rad, Sum& sum) const {
  for (const Ray& ray : rays_) {
    const double d = difference(ray, model, guess);
    const bool one_sided = ray.below == 0 || ray.above == 0;
    if (one_sided && d < bound_rad) continue;
    sum.weight += ray.weight;
    if (d < bound_rad) sum.value += ray.weight;
  }
}

void SeenSkyline::residuals(const Horizon& model, const Guess& g, std::vector<Residual>& out) const {
  out.clear();
  for (const Ray& ray : rays_) {
    const double up = g.tilt_east * ray.cosine - g.tilt_north * ray.sine;
    const double round = g.yaw + ray.slope * (g.tilt_north * ray.cosine + g.tilt_east * ray.sine);
    double value = model.elevation_at(ray.azimuth + round) - ray.elevation - up;
    if ((value < 0 && ray.below == 0) || (value > 0 && ray.above == 0)) continue;
    out.push_back({ray.azimuth + round, value, ray.weight, ray.slope, ray.cosine, ray.sine});
  }
}

}  // namespace odograph::skyline
