// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/roof_line.hpp"

#include <algorithm>
#include <cmath>

namespace odograph::skyline {
namespace {

constexpr int kN = RoofLine::kDirections;
constexpr double kSteps = kN / (2 * std::numbers::pi);
constexpr double kSteepest = 20;  // max tangent of the elevation: the azimuth is undefined towards the zenith
constexpr double kMinWeight = 0.1;
constexpr int kHalfBins = 15;  // of the histogram of a building's height; bins of 0.3 m for a sigma of 1.5 m
constexpr double kVotedSigmas = 3;

}  // namespace

void RoofLine::set(const Horizon& horizon, const City::EdgeIndices& edge_indices, const std::vector<Edge>& edges,
                   const RoofErrorParameters& p) {
  std::array<int, kDirections> known;  // object of the model by local number
  objects = 0;
  int last = Edge::kGround, last_number = -1;
  for (size_t j = 0; j < kDirections; ++j) {
    elevation[j] = horizon.elevation[j];
    const double r = static_cast<double>(horizon.distance_m[j]), c = std::cos(static_cast<double>(elevation[j]));
    per_m[j] = r > 0 ? static_cast<float>(c * c / std::max(r, 1.0)) : 0.0f;
    const double detail = p.detail_m * static_cast<double>(per_m[j]);
    const double variance = p.line_rad * p.line_rad + detail * detail;
    inverse_sigma[j] = static_cast<float>(1 / std::sqrt(variance));
    width[j] = static_cast<float>(0.5 * std::log(variance / (p.line_rad * p.line_rad)));
    const int winner = edge_indices[j], of = winner < 0 ? Edge::kGround : edges[static_cast<size_t>(winner)].object;
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

/// The model's direction of a ray, and the change of its elevation by the guess's inclination.
int RoofLineFit::direction_of(const Ray& ray, const Guess& g, double& tilt) const {
  tilt = g.tilt_east * ray.cosine - g.tilt_north * ray.sine;
  const double round = g.yaw + ray.slope * (g.tilt_north * ray.cosine + g.tilt_east * ray.sine);
  return static_cast<int>((ray.azimuth + round) * kSteps + 4 * kN) % kN;
}

/// Height error of an object's roofs, m, positive where they are higher than in the model: the value for which most of
/// its directions vote (Hough 1962), refined by iterative reweighting. A mean would lie between the roof and a tree in
/// front of it.
double RoofLineFit::offset_of(int first, double& information) const {
  constexpr int kBins = 2 * kHalfBins + 1;
  const double bin_m = kVotedSigmas * p_.building_m / kHalfBins;
  std::array<double, kBins + 2> votes{};
  for (int i = first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
    const Residual& r = residuals_[static_cast<size_t>(i)];
    const double at = r.per_m > 0 ? -r.value / (r.per_m * bin_m) : kBins;
    if (std::abs(at) <= kHalfBins) votes[static_cast<size_t>(std::lround(at) + kHalfBins + 1)] += r.weight;
  }
  double offset = 0, max_score = -1e300;
  for (int k = 0; k < kBins; ++k) {
    const auto m = static_cast<size_t>(k);
    const double there = (k - kHalfBins) * bin_m, unlikely = there / p_.building_m;
    const double score =
        (0.5 * votes[m] + votes[m + 1] + 0.5 * votes[m + 2]) * p_.above_loss / correlated_ - 0.5 * unlikely * unlikely;
    if (score > max_score) max_score = score, offset = there;
  }
  for (const double tolerance : {2.0, 1.0}) {
    double a = 1 / (p_.building_m * p_.building_m), b = 0;
    for (int i = first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
      const Residual& r = residuals_[static_cast<size_t>(i)];
      const double scale = r.inverse_sigma / tolerance, x = (r.value + r.per_m * offset) * scale;
      if (loss(x, r.width, most(r.value)) >= most(r.value)) continue;
      const double w = r.weight * 3 / (2 + x * x) * scale * scale * r.per_m / correlated_;
      a += w * r.per_m, b -= w * r.value;
    }
    offset = b / a, information = a;
  }
  return offset;
}

double RoofLineFit::no_match_cost() const {
  double sum = p_.run_loss;
  for (const Ray& ray : rays_)
    if (!ray.open && !ray.above) sum += ray.weight * p_.run_above;
  return sum;
}

/// The cheapest division of the line into the model's roofs and runs of objects that the model lacks (Viterbi 1967).
double RoofLineFit::divided() const {
  double known = 0, unknown = p_.run_loss;
  for (const Direction& d : directions_) {
    const double before = known;
    known = std::min(known, unknown) + d.known;
    unknown = std::min(unknown, before + p_.run_loss) + d.unknown;
  }
  return std::min(known, unknown);
}

double RoofLineFit::cost(const RoofLine& model, const Guess& g, size_t stride) {
  correlated_ = std::max(1.0, p_.correlated / static_cast<double>(stride));
  const auto each = static_cast<double>(stride);
  residuals_.clear(), directions_.clear();
  first_.assign(static_cast<size_t>(model.objects), -1);
  agreeing_ = edge_weight_ = 0;
  for (size_t i = 0; i < rays_.size(); i += stride) {
    const Ray& ray = rays_[i];
    double tilt = 0;
    const auto j = static_cast<size_t>(direction_of(ray, g, tilt));
    const double per_m = static_cast<double>(model.per_m[j]);
    const double value = static_cast<double>(model.elevation[j]) - ray.elevation - tilt - per_m * g.up;
    if ((value > 0 && ray.above) || (value < 0 && ray.open)) continue;
    const bool edge = !ray.open && !ray.above;
    const double sigma = static_cast<double>(model.inverse_sigma[j]), width = static_cast<double>(model.width[j]);
    directions_.push_back({0, each * ray.weight * (value > 0 ? p_.run_below : p_.run_above)});
    if (model.object[j] < 0) {
      directions_.back().known = ray.weight * loss(value * sigma, width, most(value)) / correlated_;
      if (edge) edge_weight_ += ray.weight, agreeing_ += agrees(value, sigma) ? ray.weight : 0;
      continue;
    }
    int& first = first_[static_cast<size_t>(model.object[j])];
    residuals_.push_back({value, per_m, sigma, width, ray.weight, edge, directions_.size() - 1, first});
    first = static_cast<int>(residuals_.size()) - 1;
  }
  double heights = 0;
  for (const int first : first_) {
    if (first < 0) continue;
    double information = 1;
    const double offset = offset_of(first, information);
    for (int i = first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
      const Residual& r = residuals_[static_cast<size_t>(i)];
      const double x = (r.value + r.per_m * offset) * r.inverse_sigma;
      directions_[r.direction].known = r.weight * loss(x, r.width, most(r.value)) / correlated_;
      if (r.edge) edge_weight_ += r.weight, agreeing_ += agrees(x / r.inverse_sigma, r.inverse_sigma) ? r.weight : 0;
    }
    heights += 0.5 * offset * offset / (p_.building_m * p_.building_m);
    heights += 0.5 * std::log(information * p_.building_m * p_.building_m);  // Occam's factor
  }
  return divided() + heights;
}

}  // namespace odograph::skyline
