// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/roof_line.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::skyline {
namespace {

constexpr int kN = RoofLine::kDirections;
constexpr double kSteps = kN / (2 * std::numbers::pi);
constexpr double kSteepest = 20;  // tangent of the elevation: towards the zenith an azimuth means nothing
constexpr double kMinWeight = 0.1;

}  // namespace

void RoofLine::set(const Horizon& horizon, const City::Winners& winners, const std::vector<Edge>& edges,
                   const RoofErrorParameters& p) {
  std::array<int, kDirections> known;  // objects of the model by their numbers here
  objects = 0;
  int last = Edge::kGround, last_number = -1;
  for (size_t j = 0; j < kDirections; ++j) {
    elevation[j] = horizon.elevation[j];
    const double r = static_cast<double>(horizon.distance_m[j]), c = std::cos(static_cast<double>(elevation[j]));
    per_m[j] = r > 0 ? static_cast<float>(c * c / std::max(r, 1.0)) : 0.0f;
    const double detail = p.detail_m * static_cast<double>(per_m[j]),
                 height = p.building_m * static_cast<double>(per_m[j]);
    const double variance = p.line_rad * p.line_rad + detail * detail;
    inverse_sigma[j] = static_cast<float>(1 / std::sqrt(variance));
    wide_inverse_sigma[j] = static_cast<float>(1 / std::sqrt(variance + height * height));
    width[j] = static_cast<float>(0.5 * std::log(variance / (p.line_rad * p.line_rad)));
    wide_width[j] = static_cast<float>(0.5 * std::log((variance + height * height) / (p.line_rad * p.line_rad)));
    const int winner = winners[j], of = winner < 0 ? Edge::kGround : edges[static_cast<size_t>(winner)].object;
    if (of == Edge::kGround) {
      object[j] = -1;
      continue;
    }
    if (of != last || of == Edge::kUnknown) {
      const int* const end = known.data() + objects;
      const int* const at = of == Edge::kUnknown ? end : std::find<const int*>(known.data(), end, of);
      last = of, last_number = static_cast<int>(at - known.data());
      if (at == end) known[static_cast<size_t>(objects++)] = of;
    }
    object[j] = static_cast<int16_t>(last_number);
  }
}

void RoofLineFit::set(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c) {
  rays_.clear();
  for (const SkyEdge& e : edges) {
    const Eigen::Vector3d u = q_n_c * e.ray_c;
    const double horizontal = std::hypot(u.x(), u.y());
    Ray ray{};
    ray.azimuth = std::atan2(u.y(), u.x()), ray.elevation = std::atan2(-u.z(), horizontal);
    ray.slope = std::clamp(-u.z() / std::max(horizontal, 1e-9), -kSteepest, kSteepest);
    ray.cosine = std::cos(ray.azimuth), ray.sine = std::sin(ray.azimuth);
    ray.weight = kMinWeight + (1 - kMinWeight) * e.weight;
    ray.open = e.open, ray.above = e.above;
    rays_.push_back(ray);
  }
}

/// The model's direction that a ray points to, and by how much the guess's inclination lifts the ray.
int RoofLineFit::direction_of(const Ray& ray, const Guess& g, double& tilt) const {
  tilt = g.tilt_east * ray.cosine - g.tilt_north * ray.sine;
  const double round = g.yaw + ray.slope * (g.tilt_north * ray.cosine + g.tilt_east * ray.sine);
  return static_cast<int>((ray.azimuth + round) * kSteps + 4 * kN) % kN;
}

double RoofLineFit::coarse(const RoofLine& model, const Guess& g) const {
  constexpr size_t kStride = 3;
  double sum = 0;
  for (size_t i = 0; i < rays_.size(); i += kStride) {
    const Ray& ray = rays_[i];
    double tilt = 0;
    const auto j = static_cast<size_t>(direction_of(ray, g, tilt));
    const double value =
        static_cast<double>(model.elevation[j]) - ray.elevation - tilt - static_cast<double>(model.per_m[j]) * g.up;
    if ((value > 0 && ray.above) || (value < 0 && ray.open)) continue;
    sum += ray.weight * loss(value * static_cast<double>(model.wide_inverse_sigma[j]),
                             static_cast<double>(model.wide_width[j]), most(value));
  }
  return kStride * sum / p_.correlated;
}

/// By how many metres the roofs of an object are higher than the model has them: iteratively reweighted, from a wide
/// tolerance to a narrow one.
double RoofLineFit::offset_of(int first, double& information) const {
  double offset = 0;
  for (int round = 0; round < 4; ++round) {
    double a = 1 / (p_.building_m * p_.building_m), b = 0;
    for (int i = first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
      const Residual& r = residuals_[static_cast<size_t>(i)];
      const double scale = round == 0 ? r.wide_inverse_sigma : r.inverse_sigma / (round == 1 ? 2.0 : 1.0);
      const double now = r.value + r.per_m * offset, x = now * scale;
      if (round > 1 && loss(x, r.width, most(r.value)) >= most(r.value)) continue;
      const double w = r.weight * 3 / (2 + x * x) * scale * scale * r.per_m / p_.correlated;
      a += w * r.per_m, b -= w * r.value;
    }
    offset = b / a, information = a;
  }
  return offset;
}

double RoofLineFit::nothing() const {
  double sum = 0;
  for (const Ray& ray : rays_)
    if (!ray.open && !ray.above) sum += ray.weight * p_.above_loss / p_.correlated;
  return sum;
}

double RoofLineFit::fine(const RoofLine& model, const Guess& g) {
  residuals_.clear();
  first_.assign(static_cast<size_t>(model.objects), -1);
  agreeing_ = edge_weight_ = 0;
  double sum = 0;
  for (const Ray& ray : rays_) {
    double tilt = 0;
    const auto j = static_cast<size_t>(direction_of(ray, g, tilt));
    const double per_m = static_cast<double>(model.per_m[j]);
    const double value = static_cast<double>(model.elevation[j]) - ray.elevation - tilt - per_m * g.up;
    if ((value > 0 && ray.above) || (value < 0 && ray.open)) continue;
    const bool edge = !ray.open && !ray.above;
    const double sigma = static_cast<double>(model.inverse_sigma[j]);
    if (model.object[j] < 0) {
      const double x = value * sigma;
      sum += ray.weight * loss(x, static_cast<double>(model.width[j]), most(value)) / p_.correlated;
      if (edge) edge_weight_ += ray.weight, agreeing_ += agrees(value, sigma) ? ray.weight : 0;
      continue;
    }
    int& first = first_[static_cast<size_t>(model.object[j])];
    residuals_.push_back({value, per_m, sigma, static_cast<double>(model.wide_inverse_sigma[j]),
                          static_cast<double>(model.width[j]), ray.weight, edge, first});
    first = static_cast<int>(residuals_.size()) - 1;
  }
  for (const int first : first_) {
    if (first < 0) continue;
    double information = 1;
    const double offset = offset_of(first, information);
    double own = 0, all = 0;
    for (int i = first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
      const Residual& r = residuals_[static_cast<size_t>(i)];
      const double x = (r.value + r.per_m * offset) * r.inverse_sigma;
      own += r.weight * loss(x, r.width, most(r.value)) / p_.correlated;
      all += r.weight * p_.above_loss / p_.correlated;
      if (r.edge) edge_weight_ += r.weight, agreeing_ += agrees(x / r.inverse_sigma, r.inverse_sigma) ? r.weight : 0;
    }
    own += 0.5 * offset * offset / (p_.building_m * p_.building_m);
    own += 0.5 * std::log(information * p_.building_m * p_.building_m);  // of all heights that it may have, few fit
    sum += std::min(own, p_.missing_loss + p_.missing_of * all);
  }
  return sum;
}

}  // namespace odograph::skyline
