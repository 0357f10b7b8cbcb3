// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/roof_line.hpp"

#include <algorithm>
#include <cmath>

#include "plugins/fix/skyline/straight_edges.hpp"

namespace odograph::skyline {
namespace {

constexpr int kN = RoofLine::kDirections;
constexpr double kSteps = kN / (2 * std::numbers::pi);
constexpr double kSteepest = 20;  // max tangent of the elevation: the azimuth is undefined towards the zenith
constexpr double kMinWeight = 0.1;
constexpr int kHalfBins = 15;  // of the histogram of a building's height; bins of 0.3 m for a sigma of 1.5 m
constexpr double kVotedSigmas = 3;
constexpr double kBorderGap = 2 * std::numbers::pi / 180;  // rad; neighbouring directions are half a degree apart

double azimuth_of(const SkyEdge& edge, const Eigen::Quaterniond& q_n_c) {
  const Eigen::Vector3d u = q_n_c * edge.ray_c;
  return std::atan2(u.y(), u.x());
}

/// The edges, in the order of their azimuths, from one border of the picture to the other: they begin at north, which
/// may be in its middle. Unchanged without a gap, as around the zenith.
void begin_at_border(std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c) {
  size_t first = 0;
  double widest = kBorderGap;
  for (size_t i = 0; i < edges.size(); ++i) {
    const double before = azimuth_of(edges[i > 0 ? i - 1 : edges.size() - 1], q_n_c);
    const double gap = std::abs(std::remainder(azimuth_of(edges[i], q_n_c) - before, 2 * std::numbers::pi));
    if (gap > widest) widest = gap, first = i;
  }
  std::rotate(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(first), edges.end());
}

}  // namespace

void RoofLine::set(const RoofTops& tops) {
  layers.clear(), objects.clear();
  for (size_t j = 0; j < kDirections; ++j) {
    first[j] = static_cast<uint32_t>(layers.size());
    for (uint8_t k = 0; k < tops.count[j]; ++k) {
      const RoofTop& top = tops.of[j][k];
      const double r = static_cast<double>(top.distance_m), e = std::atan2(static_cast<double>(top.height_m), r);
      const double per_m = std::cos(e) * std::cos(e) / std::max(r, 1.0);
      int number = -1;
      if (top.object != Edge::kGround) {
        const auto at = std::find(objects.rbegin(), objects.rend(), top.object);
        number = static_cast<int>(objects.rend() - at) - 1;
        if (number < 0) number = static_cast<int>(objects.size()), objects.push_back(top.object);
      }
      layers.push_back({static_cast<float>(e), 0, static_cast<float>(per_m), number});
    }
  }
  first[kDirections] = static_cast<uint32_t>(layers.size());
  // The slope along an edge, from its next direction or its last one.
  for (size_t j = 0; j + 1 < kDirections; ++j)
    for (uint8_t k = 0; k < tops.count[j]; ++k)
      for (uint8_t m = 0; m < tops.count[j + 1]; ++m)
        if (tops.of[j][k].edge == tops.of[j + 1][m].edge && tops.of[j][k].object == tops.of[j + 1][m].object) {
          Layer &a = layers[first[j] + k], &b = layers[first[j + 1] + m];
          a.slope = b.slope = (b.elevation - a.elevation) * static_cast<float>(kSteps);
        }
}

void RoofLineFit::set(std::vector<SkyEdge> edges, const Eigen::Quaterniond& q_n_c) {
  begin_at_border(edges, q_n_c);
  rays_.clear();
  std::vector<double> weights;
  for (const SkyEdge& e : edges) {
    const Eigen::Vector3d u = q_n_c * e.ray_c;
    const double horizontal = std::hypot(u.x(), u.y());
    Ray ray{};
    ray.azimuth = std::atan2(u.y(), u.x()), ray.elevation = std::atan2(-u.z(), horizontal);
    ray.slope = std::clamp(-u.z() / std::max(horizontal, 1e-9), -kSteepest, kSteepest);
    ray.cosine = std::cos(ray.azimuth), ray.sine = std::sin(ray.azimuth);
    ray.weight = kMinWeight + (1 - kMinWeight) * e.weight;
    ray.open = e.open, ray.above = e.above;
    rays_.push_back(ray), weights.push_back(ray.open || ray.above ? 0 : ray.weight);
  }
  double north = 0, east = 0;
  for (const Ray& ray : rays_) north += ray.cosine, east += ray.sine;
  middle_ = std::atan2(east, north), half_width_ = 0;
  for (const Ray& ray : rays_)
    half_width_ = std::max(half_width_, std::abs(std::remainder(ray.azimuth - middle_, 2 * std::numbers::pi)));
  const std::vector<int> straight = straight_edges(
      edges, weights, {p_.straight_loss, p_.straight_rad, p_.run_above, loss_of_exact(), 1 / p_.correlated});
  for (size_t i = 0; i < rays_.size(); ++i) rays_[i].edge = straight[i];
}

/// The model's direction of a ray, the ray's azimuth from its middle, rad, and the change of the ray's elevation by the
/// guess's inclination.
size_t RoofLineFit::direction_of(const Ray& ray, const Guess& g, double& tilt, double& aside) const {
  tilt = g.tilt_east * ray.cosine - g.tilt_north * ray.sine;
  const double round = g.yaw + ray.slope * (g.tilt_north * ray.cosine + g.tilt_east * ray.sine);
  const double at = (ray.azimuth + round) * kSteps + 4 * kN;
  const int whole = static_cast<int>(at);
  aside = (at - whole - 0.5) / kSteps;
  return static_cast<size_t>(whole % kN);
}

/// Height error of an object's roofs, m, positive where they are higher than in the model: the value for which most of
/// its directions vote (Hough 1962). A roof above the line contradicts it, one below may have another behind it. An
/// object that is contradicted at every height is absent.
void RoofLineFit::vote(Object& object) const {
  constexpr int kBins = 2 * kHalfBins + 1;
  const double bin_m = kVotedSigmas * p_.building_m / kHalfBins;
  std::array<float, kBins + 3> agree{}, sum{}, contradict{};  // contradict[k]: by heights from bin k on
  for (int i = object.first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
    const Residual& r = residuals_[static_cast<size_t>(i)];
    const Ray& ray = ray_of(r);
    if (ray.above) continue;
    const double at = std::clamp(r.offset / bin_m, -kHalfBins - 1.0, kHalfBins + 2.0);
    const auto k = static_cast<size_t>(std::lround(at) + kHalfBins + 1);
    const auto w = static_cast<float>(ray.weight);
    if (!ray.open && at >= -kHalfBins) agree[k] += w, sum[k] += w * static_cast<float>(at);
    if (k + 2 < contradict.size()) contradict[k + 2] += w;
  }
  double max_score = -1e300, against = contradict[0];
  for (int k = 0; k < kBins; ++k) {
    const auto m = static_cast<size_t>(k);
    against += static_cast<double>(contradict[m + 1]);
    const double there = (k - kHalfBins) * bin_m, unlikely = there / p_.building_m;
    const double votes = static_cast<double>(0.5f * agree[m] + agree[m + 1] + 0.5f * agree[m + 2]);
    const double score = (votes * p_.above_loss - against * p_.below_loss) / correlated_ - 0.5 * unlikely * unlikely;
    if (score > max_score) {
      max_score = score;
      const auto mean = static_cast<double>(0.5f * sum[m] + sum[m + 1] + 0.5f * sum[m + 2]);
      object.offset = votes > 0 ? mean / votes * bin_m : there;
    }
  }
  object.absent = max_score < -p_.absent_loss;
}

/// The same by iterative reweighting of the directions in which the object is the skyline.
void RoofLineFit::refine(Object& object) const {
  for (const double tolerance : {2.0, 1.0}) {
    double a = 1 / (p_.building_m * p_.building_m), b = 0;
    for (int i = object.first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
      const Residual& r = residuals_[static_cast<size_t>(i)];
      const Ray& ray = ray_of(r);
      if (!r.top) continue;
      const double per_m = static_cast<double>(r.layer->per_m), value = r.value + per_m * object.offset;
      if ((value > 0 && ray.above) || (value < 0 && ray.open)) continue;
      const Accuracy accuracy{r.accuracy.inverse / tolerance, r.accuracy.variance};
      if (is_outlier(value, accuracy)) continue;
      const double scale = accuracy.inverse, x = value * scale;
      const double w = ray.weight * 3 / (2 + x * x) * scale * scale * per_m / correlated_;
      a += w * per_m, b -= w * r.value;
    }
    object.offset = b / a, object.information = a;
  }
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

double RoofLineFit::straight_gain() const {
  double known = 0, unknown = p_.run_loss, nothing = p_.run_loss;
  int last = kRagged;
  for (const Direction& d : directions_) {
    const Ray& ray = rays_[static_cast<size_t>(d.ray)];
    const double value = d.top < 0 ? d.level : value_of(residuals_[static_cast<size_t>(d.top)]);
    const double begins = ray.edge == kRagged ? 0 : p_.straight_loss, continues = ray.edge == last ? 0 : begins;
    const double cost = ray.open || ray.above ? 0 : ray.weight * (ray.edge == kRagged ? p_.run_above : loss_of_exact());
    const double before = known;
    known = std::min(known, unknown) + d.known;
    unknown = std::min(unknown + continues, before + p_.run_loss + begins) + (value > 0 ? d.unknown : cost);
    nothing += continues + cost;
    last = ray.edge;
  }
  return nothing - std::min(known, unknown) - heights_cost_;
}

/// The residuals of all layers in the picture's directions.
void RoofLineFit::compare(const RoofLine& model, const Guess& g, size_t stride) {
  residuals_.clear(), directions_.clear();
  objects_.assign(model.objects.size(), {});
  for (size_t i = 0; i < rays_.size(); i += stride) {
    const Ray& ray = rays_[i];
    double tilt = 0, aside = 0;
    const size_t j = direction_of(ray, g, tilt, aside);
    const auto direction = static_cast<int>(directions_.size()), first_residual = static_cast<int>(residuals_.size());
    directions_.push_back({static_cast<int>(i), first_residual, first_residual, -ray.elevation - tilt, 0, 0});
    for (uint32_t k = model.first[j]; k < model.first[j + 1]; ++k) {
      const RoofLine::Layer& layer = model.layers[k];
      const double per_m = static_cast<double>(layer.per_m);
      const double value = static_cast<double>(layer.elevation) + static_cast<double>(layer.slope) * aside -
                           ray.elevation - tilt - per_m * g.up;
      int* const first = layer.object < 0 ? nullptr : &objects_[static_cast<size_t>(layer.object)].first;
      residuals_.push_back({&layer, value, -value / per_m, direction, first ? *first : -1, false, {}});
      if (first) *first = static_cast<int>(residuals_.size()) - 1;
    }
    directions_.back().end = static_cast<int>(residuals_.size());
  }
}

/// A residual with the height of its object, rad.
double RoofLineFit::value_of(const Residual& r) const {
  const int object = r.layer->object;
  return object < 0 ? r.value
                    : r.value + static_cast<double>(r.layer->per_m) * objects_[static_cast<size_t>(object)].offset;
}

/// The highest of the direction's layers that `can` be the skyline; null: the horizon.
template <class Can>
RoofLineFit::Residual* RoofLineFit::highest(const Direction& d, const Can& can) {
  double highest = d.level;
  Residual* top = nullptr;
  for (int k = d.first; k < d.end; ++k) {
    Residual& r = residuals_[static_cast<size_t>(k)];
    if (r.layer->object >= 0 && !can(r.layer->object)) continue;
    if (const double value = value_of(r); value > highest) highest = value, top = &r;
  }
  return top;
}

void RoofLineFit::set_top(Direction& d, Residual* top) {
  if (d.top >= 0) residuals_[static_cast<size_t>(d.top)].top = false;
  d.top = top ? static_cast<int>(top - residuals_.data()) : -1;
  if (top) top->top = true, top->accuracy = accuracy_of(static_cast<double>(top->layer->per_m));
}

/// Finds the highest present layer of each direction.
void RoofLineFit::find_tops() {
  for (Direction& d : directions_) {
    Residual* const top = highest(d, [&](int object) { return !objects_[static_cast<size_t>(object)].absent; });
    set_top(d, top);
    if (top && top->layer->object >= 0) objects_[static_cast<size_t>(top->layer->object)].seen = true;
  }
}

/// Of a direction with this layer as the skyline, null: the horizon.
double RoofLineFit::cost_of(const Direction& d, const Residual* top) const {
  const Ray& ray = rays_[static_cast<size_t>(d.ray)];
  const double value = top ? value_of(*top) : d.level;
  if ((value > 0 && ray.above) || (value < 0 && ray.open)) return 0;
  const Accuracy accuracy = !top       ? horizon_
                            : top->top ? top->accuracy
                                       : accuracy_of(static_cast<double>(top->layer->per_m));
  return ray.weight * loss(value, accuracy) / correlated_;
}

/// Of an object's height: its prior, and Occam's factor (MacKay 2003, chapter 28) where it is fitted.
double RoofLineFit::cost_of_height(const Object& object, bool seen) const {
  const double variance = p_.building_m * p_.building_m;
  double cost = 0.5 * object.offset * object.offset / variance;
  if (seen) return cost + 0.5 * std::log(object.information * variance);
  return object.offset > 0 ? 0 : cost;  // a roof that another hides may have any height below it
}

/// Hides an object in view whose height costs more than it explains: those behind it explain nearly the same. Two
/// roofs that are level would otherwise be in view or not by a millimetre, and the cost would change in steps.
void RoofLineFit::hide_needless(int number) {
  Object& object = objects_[static_cast<size_t>(number)];
  const auto is_other = [&](int o) { return o != number && objects_[static_cast<size_t>(o)].seen; };
  double needless = cost_of_height(object, true) - cost_of_height(object, false);
  tops_.clear();
  for (int i = object.first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
    const Residual& r = residuals_[static_cast<size_t>(i)];
    if (!r.top) continue;
    const Direction& d = directions_[static_cast<size_t>(r.direction)];
    tops_.push_back({r.direction, highest(d, is_other)});
    needless += cost_of(d, &r) - cost_of(d, tops_.back().second);
  }
  if (needless <= 0) return;
  object.seen = false;
  for (const auto& [direction, top] : tops_) {
    set_top(directions_[static_cast<size_t>(direction)], top);
    if (top && top->layer->object >= 0) objects_[static_cast<size_t>(top->layer->object)].changed = true;
  }
}

/// Refines the heights of the objects in view, those with the most expensive ones hidden first; their cost.
double RoofLineFit::cost_of_heights() {
  order_.clear();
  for (size_t k = 0; k < objects_.size(); ++k)
    if (objects_[k].seen)
      refine(objects_[k]), order_.push_back({cost_of_height(objects_[k], true), static_cast<int>(k)});
  std::sort(order_.rbegin(), order_.rend());
  const auto update = [&](Object& object) {
    if (object.changed) refine(object), object.changed = false;
  };
  for (const auto& [height, number] : order_) update(objects_[static_cast<size_t>(number)]), hide_needless(number);
  double cost = 0;
  for (Object& object : objects_) {
    if (object.seen) update(object);
    if (object.first >= 0) cost += object.absent ? p_.absent_loss : cost_of_height(object, object.seen);
  }
  return cost;
}

std::vector<RoofHeight> RoofLineFit::heights(const RoofLine& model) const {
  std::vector<RoofHeight> heights;
  for (size_t k = 0; k < objects_.size(); ++k) {
    if (!objects_[k].seen || model.objects[k] < 0) continue;
    heights.push_back({model.objects[k], objects_[k].offset, 0});
    for (int i = objects_[k].first; i >= 0; i = residuals_[static_cast<size_t>(i)].next) {
      const Residual& r = residuals_[static_cast<size_t>(i)];
      const Ray& ray = ray_of(r);
      if (r.top && !ray.open && !ray.above && agrees(value_of(r), r.accuracy)) heights.back().directions += ray.weight;
    }
  }
  return heights;
}

RoofLineFit::NormalEquations RoofLineFit::normal_equations(const Guess& g) const {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  struct Height {
    double information, gradient;
    Vector6 coupling = Vector6::Zero();
  };
  const double prior = 1 / (p_.building_m * p_.building_m);
  std::vector<Height> heights(objects_.size(), {prior, 0});
  for (size_t i = 0; i < objects_.size(); ++i) heights[i].gradient = prior * objects_[i].offset;
  NormalEquations normal;
  for (const Direction& d : directions_) {
    if (d.top < 0) continue;
    const Residual& r = residuals_[static_cast<size_t>(d.top)];
    const Ray& ray = rays_[static_cast<size_t>(d.ray)];
    const double value = value_of(r), x = value * r.accuracy.inverse;
    if ((value > 0 && ray.above) || (value < 0 && ray.open) || is_outlier(value, r.accuracy)) continue;
    const double per_m = static_cast<double>(r.layer->per_m), slope = static_cast<double>(r.layer->slope);
    const double azimuth = ray.azimuth + g.yaw, north = std::cos(azimuth), east = std::sin(azimuth);
    // A step towards the roof raises it; one aside turns it by the inverse of its distance.
    const double nearer = per_m * std::tan(static_cast<double>(r.layer->elevation));
    const double e = static_cast<double>(r.layer->elevation), aside = slope * per_m / (std::cos(e) * std::cos(e));
    Vector6 j;
    j << nearer * north - aside * east, nearer * east + aside * north, slope, ray.sine + slope * ray.slope * ray.cosine,
        -ray.cosine + slope * ray.slope * ray.sine, -per_m;
    const double w = ray.weight * 3 / (2 + x * x) * r.accuracy.inverse * r.accuracy.inverse / correlated_;
    normal.information += j * (w * j).transpose();
    normal.gradient += w * value * j;
    if (r.layer->object < 0) continue;
    Height& height = heights[static_cast<size_t>(r.layer->object)];
    height.information += w * per_m * per_m, height.gradient += w * per_m * value, height.coupling += w * per_m * j;
  }
  for (const Height& h : heights) {
    normal.information -= h.coupling * (1 / h.information * h.coupling).transpose();
    normal.gradient -= h.gradient / h.information * h.coupling;
  }
  return normal;
}

double RoofLineFit::cost(const RoofLine& model, const Guess& g, size_t stride) {
  correlated_ = std::max(1.0, p_.correlated / static_cast<double>(stride));
  horizon_ = accuracy_of(0);
  compare(model, g, stride);
  for (Object& object : objects_)
    if (object.first >= 0) vote(object);
  find_tops();
  const double heights = heights_cost_ = cost_of_heights();
  agreeing_ = edge_weight_ = 0;
  for (Direction& d : directions_) {
    const Ray& ray = rays_[static_cast<size_t>(d.ray)];
    const Residual* const top = d.top < 0 ? nullptr : &residuals_[static_cast<size_t>(d.top)];
    const double value = top ? value_of(*top) : d.level;
    if ((value > 0 && ray.above) || (value < 0 && ray.open)) continue;
    d.known = cost_of(d, top);
    d.unknown = static_cast<double>(stride) * ray.weight * (value > 0 ? p_.run_below : p_.run_above);
    if (!ray.open && !ray.above)
      edge_weight_ += ray.weight, agreeing_ += agrees(value, top ? top->accuracy : horizon_) ? ray.weight : 0;
  }
  return divided() + heights;
}

}  // namespace odograph::skyline
