// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sdk/math/rotation.hpp"
#include "sdk/math/scalar.hpp"

namespace odograph {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Whether a point lies within a convex outline, whose interior is on the left.
bool contains(const std::vector<Vector2d>& outline, const Vector2d& p) {
  for (size_t i = 0; i < outline.size(); ++i) {
    const Vector2d side = outline[(i + 1) % outline.size()] - outline[i], to = p - outline[i];
    if (side.x() * to.y() - side.y() * to.x() < 0) return false;
  }
  return !outline.empty();
}

/// Distance along a ray to a plane; nothing behind its origin or beyond `max_m`.
std::optional<double> distance_to_plane(const Scene::Ray& ray, const Vector3d& p_n, const Vector3d& normal_n) {
  const double approach = normal_n.dot(ray.direction_n);
  if (std::abs(approach) < 1e-9) return std::nullopt;
  const double distance_m = normal_n.dot(p_n - ray.origin_n) / approach;
  if (!(distance_m > 0 && distance_m < ray.max_distance_m)) return std::nullopt;
  return distance_m;
}

}  // namespace

void Scene::see(const odo_pose& pose) {
  constexpr uint32_t needed = ODO_POSE_POSITION | ODO_POSE_ORIENTATION | ODO_POSE_METRIC;
  if ((pose.header.flags & needed) != needed || !(pose.scale > 0 && pose.scale_sigma > 0)) return;  // 0: unknown
  scale_sigma_ = FrameLandmarks::scale_sigma(pose);
  const Rigid T_m_c = T_n_m_.inverse() * Rigid{quaternion(pose.q_n), Vector3d(pose.p_n)};
  eye_m_ = T_m_c.p;
  frame_.place(pose, T_m_c.q, T_m_c.p, [this](const MapPoint& point) { points_.add(point); });
}

const Scene::Surface* Scene::take(odo_surface& message, uint32_t resets) {
  const auto of_finder = [&](uint64_t own_id) {
    return std::find_if(surfaces_.begin(), surfaces_.end(), [&](const Surface& s) {
      return s.source == message.header.source && s.resets == resets && s.own_id == own_id;
    });
  };
  auto found = of_finder(message.id);
  const auto into = message.state == ODO_SURFACE_MERGED ? of_finder(message.merged_into) : surfaces_.end();
  message.merged_into = into != surfaces_.end() ? into->id : 0;
  if (message.state != ODO_SURFACE_PRESENT) {
    if (into == surfaces_.end()) message.state = ODO_SURFACE_WITHDRAWN;  // nothing to be part of
    message.id = found != surfaces_.end() ? found->id : 0;
    if (found != surfaces_.end()) remove(static_cast<size_t>(found - surfaces_.begin()));
    return nullptr;
  }
  if (found == surfaces_.end()) {
    if (surfaces_.size() >= p_.max_surfaces) return message.id = 0, nullptr;
    surfaces_.emplace_back();
    found = surfaces_.end() - 1;
    found->id = ++last_id_, found->source = message.header.source, found->resets = resets, found->own_id = message.id;
  }
  Surface& surface = *found;
  surface.kind = message.kind, surface.t_ns = message.header.t_ns;
  surface.sigma_m = message.sigma_m, surface.tilt_sigma_rad = message.tilt_sigma_rad;
  surface.scale_sigma = scale_sigma_.value_or(0), surface.eye_m = eye_m_;
  surface.T_m_s = T_n_m_.inverse() * Rigid{quaternion(message.q_n), Vector3d(message.p_n)};
  surface.outline.clear();
  for (uint32_t i = 0; i < message.count; ++i)
    if (const odo_vertex* vertex = ODO_VERTEX_AT(&message, i))
      surface.outline.emplace_back(static_cast<double>(vertex->p[0]), static_cast<double>(vertex->p[1]));
  message.id = surface.id;
  return &surface;
}

std::vector<Scene::Surface> Scene::take_orphans(uint32_t source, uint32_t resets) {
  std::vector<Surface> orphans;
  for (size_t i = surfaces_.size(); i-- > 0;) {
    if (surfaces_[i].source != source || surfaces_[i].resets == resets) continue;
    orphans.push_back(std::move(surfaces_[i]));
    remove(i);
  }
  return orphans;
}

const Scene::Surface* Scene::find(uint64_t id) const {
  const auto found = std::find_if(surfaces_.begin(), surfaces_.end(), [id](const Surface& s) { return s.id == id; });
  return found != surfaces_.end() ? &*found : nullptr;
}

/// Where a ray meets a surface's plane; within its outline, or also `beyond` it.
std::optional<Scene::Hit> Scene::hit_surface(const Ray& ray, const Surface& surface, const Vector3d& phone_n,
                                             bool beyond) const {
  const Rigid T_n_s = T_n_m_ * surface.T_m_s;
  const Vector3d normal_n = T_n_s.q * Vector3d::UnitZ();
  const auto distance_m = distance_to_plane(ray, T_n_s.p, normal_n);
  if (!distance_m) return std::nullopt;
  const Vector3d p_n = ray.origin_n + *distance_m * ray.direction_n;
  if (!beyond && !contains(surface.outline, (T_n_s.inverse() * p_n).head<2>())) return std::nullopt;
  const double across_m = std::hypot(surface.sigma_m, surface.tilt_sigma_rad * (p_n - phone_n).norm());
  const double moved_m = (T_n_m_ * surface.eye_m - phone_n).norm();
  return Hit{beyond ? ODO_HIT_FLOOR : ODO_HIT_SURFACE,
             &surface,
             p_n,
             normal_n,
             *distance_m,
             across_m / std::abs(normal_n.dot(ray.direction_n)),
             surface.scale_sigma,
             moved_m};
}

/// How much farther or nearer the landmarks around one are, per radian; as at 45 degrees where there are none.
double Scene::slope_beside(const MapPoint& landmark, const Vector3d& origin_m) const {
  const Vector3d to = landmark.p - origin_m;
  const double distance_m = to.norm(), min_rad = 0.5 * p_.hit_cone_rad, min_cos = std::cos(p_.beside_rad);
  double sum = squared(distance_m), count = 1;
  visit_current([&](const MapPoint& other) {
    const Vector3d to_other = other.p - origin_m;
    const double other_m = to_other.norm(), cos = to.dot(to_other) / (distance_m * other_m);
    if (!(cos > min_cos) || &other == &landmark) return;
    const double apart_rad = std::max(min_rad, std::acos(std::min(1.0, cos)));
    sum += squared((other_m - distance_m) / apart_rad), ++count;
  });
  return std::sqrt(sum / count);
}

/// The landmark nearest to the ray, within the cone.
std::optional<Scene::Hit> Scene::hit_point(const Ray& ray, const Vector3d& phone_n) const {
  const Rigid T_m_n = T_n_m_.inverse();
  const Vector3d origin_m = T_m_n * ray.origin_n, direction_m = T_m_n.q * ray.direction_n;
  double best = squared(std::tan(p_.hit_cone_rad));
  const MapPoint* found = nullptr;
  visit_current([&](const MapPoint& point) {
    const Vector3d to = point.p - origin_m;
    const double along_m = to.dot(direction_m);
    if (!(along_m > 0 && along_m < ray.max_distance_m)) return;
    const double off = to.squaredNorm() / squared(along_m) - 1;  // squared tangent of the angle
    if (off < best) best = off, found = &point;
  });
  if (!found) return std::nullopt;
  const double along_m = (found->p - origin_m).dot(direction_m);
  const double own_m = std::sqrt(direction_m.dot(found->covariance.cast<double>() * direction_m));
  const double beside_m = std::sqrt(std::max(0.0, best)) * slope_beside(*found, origin_m);
  return Hit{ODO_HIT_POINT,
             nullptr,
             ray.origin_n + along_m * ray.direction_n,
             -ray.direction_n,
             along_m,
             std::hypot(own_m, beside_m),
             static_cast<double>(found->scale_sigma),
             (T_n_m_ * found->eye.cast<double>().eval() - phone_n).norm()};
}

/// The floor that is assumed below a walker's hand.
std::optional<Scene::Hit> Scene::hit_assumed_floor(const Ray& ray, const Vector3d& phone_n) const {
  const Vector3d below_n(phone_n.x(), phone_n.y(), phone_n.z() + p_.hand * walker_m_), up_n = -Vector3d::UnitZ();
  const auto distance_m = walker_m_ > 0 ? distance_to_plane(ray, below_n, up_n) : std::nullopt;
  if (!distance_m) return std::nullopt;
  return Hit{ODO_HIT_FLOOR, nullptr,     ray.origin_n + *distance_m * ray.direction_n,
             up_n,          *distance_m, p_.hand_sigma * walker_m_ / std::abs(ray.direction_n.z())};
}

size_t Scene::cast(const Ray& ray, const Vector3d& phone_n, Hit* hits, size_t capacity) const {
  if (!is_metric()) return 0;
  size_t count = 0;
  const auto add = [&](Hit hit) {
    hit.scale_sigma = std::max(*scale_sigma_, hit.scale_sigma);
    const double by_track_m = std::hypot(p_.drift, hit.scale_sigma) * hit.moved_m;
    hit.sigma_m = std::hypot(hit.sigma_m, by_track_m, hit.scale_sigma * (hit.p_n - phone_n).norm());
    size_t at = count;
    while (at > 0 && hits[at - 1].distance_m > hit.distance_m) --at;
    if (at == capacity) return;
    count = std::min(count + 1, capacity);
    std::move_backward(hits + at, hits + count - 1, hits + count);
    hits[at] = hit;
  };
  const Surface* floor = nullptr;
  std::optional<Hit> nearest;  // of the surfaces
  for (const Surface& surface : surfaces_) {
    if (surface.kind == ODO_SURFACE_FLOOR) floor = &surface;
    const auto hit = hit_surface(ray, surface, phone_n, false);
    if (!hit) continue;
    if (!nearest || hit->distance_m < nearest->distance_m) nearest = hit;
    if (ray.wanted & ODO_HIT_SURFACE) add(*hit);
  }
  if (const auto point = ray.wanted & ODO_HIT_POINT ? hit_point(ray, phone_n) : std::nullopt) {
    const bool is_part = nearest && std::abs(point->distance_m - nearest->distance_m) <
                                        p_.explained * std::hypot(point->sigma_m, nearest->sigma_m);
    if (!is_part) add(*point);
  }
  if (ray.wanted & ODO_HIT_FLOOR) {
    const auto hit = floor ? hit_surface(ray, *floor, phone_n, true) : hit_assumed_floor(ray, phone_n);
    if (hit && !(nearest && nearest->surface == floor)) add(*hit);
  }
  return count;
}

}  // namespace odograph
