// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/world_view.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/host/messages/bounds.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/base/pose_frame.hpp"
#include "sdk/host/base/saturating.hpp"
#include "sdk/math/lens.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// An anchor is degraded if the visible error's sigma is above the larger of these: m, a hand's breadth at arm's
/// length, and relative to its distance, a few degrees; judgement.
constexpr double kUncertain_m = 0.25, kUncertain = 0.1;

/// The body's pose to the camera's, or back.
void convert(const CameraTable::Mount& mount, odo_pose& pose) {
  if (pose.header.flags & ODO_POSE_CAMERA)
    move_pose(mount.q_b_c.conjugate(), -(mount.q_b_c.conjugate() * mount.p_b_c), pose);
  else
    move_pose(mount.q_b_c, mount.p_b_c, pose);
  pose.header.flags ^= ODO_POSE_CAMERA;
}

Rigid rigid(const odo_pose& pose) { return {quaternion(pose.q_n), Vector3d(pose.p_n)}; }

void put(const Rigid& from, double* q, double* p) {
  put_quaternion(from.q, q);
  Vector3d::Map(p) = from.p;
}

bool is_rotation(const double* q) {
  constexpr double kRounded = 0.01;  // of the norm: accepts a quaternion of floats, or one written with few digits
  const double norm = Eigen::Map<const Eigen::Vector4d>(q).norm();
  return norm == 0 || std::abs(norm - 1) < kRounded;
}

/// All zeros mean no rotation.
Rigid placed(const odo_anchor_place& place) {
  const Quaterniond q(place.q[0], place.q[1], place.q[2], place.q[3]);
  return {q.norm() > 0 ? q.normalized() : Quaterniond::Identity(), Vector3d(place.p)};
}

}  // namespace

int32_t WorldView::pose_of(uint32_t of, uint32_t world, int64_t t_ns, odo_pose& out) const {
  if (of > ODO_OF_CAMERA || world > ODO_WORLD_SMOOTH) return ODO_E_ARGUMENT;
  const int32_t status = poses_.at(t_ns, world == ODO_WORLD_SMOOTH, out);
  const bool is_camera = (out.header.flags & ODO_POSE_CAMERA) != 0;
  if (status != ODO_OK || of == ODO_OF_PIPELINE || is_camera == (of == ODO_OF_CAMERA)) return status;
  const auto mount = cameras_.mount(main_camera_());
  if (!mount) return ODO_NOT_READY;
  convert(*mount, out);
  return status;
}

/// The body to which the localizer attaches anchors: without extrinsics it assumes the mount of a rear camera.
int32_t WorldView::tracked_body(int64_t t_ns, odo_pose& out) const {
  const int32_t status = poses_.at(t_ns, false, out);
  if (status == ODO_OK && (out.header.flags & ODO_POSE_CAMERA))
    convert(cameras_.mount(main_camera_()).value_or(CameraTable::Mount{.q_b_c = rear_camera_mount()}), out);
  return status;
}

int32_t WorldView::create_anchor(const odo_anchor_place& place, uint64_t& id) {
  if (place.kind < ODO_ANCHOR_POSE || place.kind > ODO_ANCHOR_HIT || place.world > ODO_WORLD_SMOOTH)
    return ODO_E_ARGUMENT;
  if (place.name.size > Anchors::kLongestName || (place.name.size > 0 && !place.name.data)) return ODO_E_ARGUMENT;
  if (!bounds::are_numbers(place.q, 4) || !is_rotation(place.q)) return ODO_E_ARGUMENT;
  if (place.kind == ODO_ANCHOR_GEODETIC) {
    const double numbers[] = {place.latitude_rad, place.longitude_rad, place.height_m, place.geoid_height_m,
                              place.sigma_m};
    if (!bounds::are_numbers(numbers, 5) || !bounds::kLatitude_rad.holds(place.latitude_rad) ||
        !bounds::kLongitude_rad.holds(place.longitude_rad) || place.sigma_m < 0)
      return ODO_E_ARGUMENT;
    if (place.height_above < ODO_HEIGHT_ELLIPSOID || place.height_above > ODO_HEIGHT_TERRAIN) return ODO_E_ARGUMENT;
    id = anchors_.add_geodetic(place);
    return id != 0 ? ODO_OK : ODO_E_EXHAUSTED;
  }
  const bool is_hit = place.kind == ODO_ANCHOR_HIT;
  if (!bounds::are_numbers(place.p, 3) || (is_hit && !bounds::kPosition_m.holds(place.sigma_m))) return ODO_E_ARGUMENT;
  if (is_hit && place.sigma_m < 0) return ODO_E_ARGUMENT;
  const std::lock_guard lock(mutex_);  // the poses and the anchor must belong to the same correction
  if (is_hit && !scene_.knows(place.surface)) return ODO_E_NOT_FOUND;
  odo_pose body{}, view{}, smooth{};
  if (const int32_t status = tracked_body(place.t_ns, body); status != ODO_OK) return status;
  if ((body.header.flags & ODO_POSE_POSITION) == 0) return ODO_NOT_READY;
  Anchors::Placement seen{body.header.t_ns, rigid(body), {}};
  if (const int32_t status = poses_.at(seen.t_ns, false, view); status != ODO_OK) return status;
  seen.T_n_a = placed(place);
  if (place.kind == ODO_ANCHOR_VIEW) {
    seen.T_n_a = rigid(view) * seen.T_n_a;
  } else if (place.world == ODO_WORLD_SMOOTH) {
    if (const int32_t status = poses_.at(seen.t_ns, true, smooth); status != ODO_OK) return status;
    seen.T_n_a = rigid(view) * rigid(smooth).inverse() * seen.T_n_a;
  }
  const Scene::Surface* surface = is_hit ? scene_.find(place.surface) : nullptr;
  if (is_hit) seen.hit_sigma_m = place.sigma_m;
  if (surface) seen.T_n_b = scene_.T_n_m() * surface->T_m_s, seen.on_surface = true, seen.sigma_m = surface->sigma_m;
  id = anchors_.add_local(place, seen);
  return id != 0 ? ODO_OK : ODO_E_EXHAUSTED;
}

int32_t WorldView::anchor(uint64_t id, uint32_t world, int64_t t_ns, odo_anchor& out) const {
  if (world > ODO_WORLD_SMOOTH) return ODO_E_ARGUMENT;
  // Pose and anchor must belong to the same correction, which moves both under this lock.
  const std::lock_guard lock(mutex_);
  odo_pose corrected{}, smooth{};
  const int32_t status = poses_.at(t_ns, false, corrected);
  const bool oriented = status == ODO_OK, seen = oriented && (corrected.header.flags & ODO_POSE_POSITION) != 0;
  if (oriented) t_ns = corrected.header.t_ns;
  const auto known = anchors_.get(id, t_ns, oriented);
  if (!known) return ODO_E_NOT_FOUND;
  out = known->anchor;
  out.t_ns = t_ns;
  const bool is_placed = out.state == ODO_TRACKING;
  if (is_placed) {
    out.flags |= ODO_ANCHOR_PLACED;
    out.state = seen ? corrected.state : ODO_LOST;
    out.reason = oriented ? corrected.reason : ODO_REASON_INITIALISING;
  }
  Rigid T_n_a = world == ODO_WORLD_SMOOTH ? known->smooth_T_n_a : known->T_n_a;
  if (is_placed && seen) {
    const Rigid T_view_a = rigid(corrected).inverse() * T_n_a;
    out.flags |= ODO_ANCHOR_VIEW_POSE;
    const bool is_camera = (corrected.header.flags & ODO_POSE_CAMERA) != 0;
    if (is_camera ? T_view_a.p.z() > 0 : T_view_a.p.z() < 0) out.flags |= ODO_ANCHOR_IN_FRONT;
    put(T_view_a, out.q_view, out.p_view);
    // In the smooth world, the anchor appears at the same place in the view as in the corrected one.
    if (world == ODO_WORLD_SMOOTH && poses_.at(t_ns, true, smooth) == ODO_OK) T_n_a = rigid(smooth) * T_view_a;
  }
  put(T_n_a, out.q_n, out.p_n);
  out.position_sigma_m = std::sqrt(known->position_variance);
  out.yaw_sigma_rad = std::sqrt(std::max(0.0, known->yaw_variance));
  out.view_sigma_m = std::sqrt(known->view_variance);
  const double uncertain_m = std::max(kUncertain_m, kUncertain * Vector3d(out.p_view).norm());
  if ((out.flags & ODO_ANCHOR_VIEW_POSE) && out.state == ODO_TRACKING && out.view_sigma_m > uncertain_m)
    out.state = ODO_DEGRADED;
  if (known->geodetic) {
    out.flags |= ODO_ANCHOR_ON_EARTH;
    out.latitude_rad = (*known->geodetic)[0], out.longitude_rad = (*known->geodetic)[1];
    out.height_m = (*known->geodetic)[2];
  }
  return ODO_OK;
}

/// From the corrected n to that of a world, where both poses are known at t.
Rigid WorldView::to_world(uint32_t world, int64_t t_ns) const {
  odo_pose corrected{}, smooth{};
  if (world != ODO_WORLD_SMOOTH || poses_.at(t_ns, false, corrected) != ODO_OK ||
      poses_.at(t_ns, true, smooth) != ODO_OK)
    return {};
  return rigid(smooth) * rigid(corrected).inverse();
}

int64_t WorldView::points(uint32_t world, const std::function<odo_map_point*(uint64_t)>& element) const {
  if (world > ODO_WORLD_SMOOTH) return ODO_E_ARGUMENT;
  const std::lock_guard lock(mutex_);
  const Rigid T_world_n = to_world(world, ODO_TIME_LATEST);
  uint64_t count = 0;
  scene_.visit_points([&](const Vector3d& p_n, double sigma_m, int64_t t_ns) {
    odo_map_point* out = element(count++);
    if (!out) return;
    out->t_ns = t_ns, out->sigma_m = sigma_m;
    Vector3d::Map(out->p_n) = T_world_n * p_n;
  });
  return static_cast<int64_t>(count);
}

std::vector<uint64_t> WorldView::surface_ids() const {
  const std::lock_guard lock(mutex_);
  std::vector<uint64_t> ids;
  for (const Scene::Surface& surface : scene_.surfaces()) ids.push_back(surface.id);
  return ids;
}

int32_t WorldView::surface(uint64_t id, uint32_t world, odo_surface& out) const {
  if (world > ODO_WORLD_SMOOTH) return ODO_E_ARGUMENT;
  const std::lock_guard lock(mutex_);
  const Scene::Surface* found = scene_.find(id);
  if (!found) return ODO_E_NOT_FOUND;
  const auto count = static_cast<uint32_t>(found->outline.size());
  const uint32_t size = sizeof(odo_surface) + count * static_cast<uint32_t>(sizeof(odo_vertex));
  if (out.header.struct_size < size) return ODO_E_STRUCT_SIZE;
  out = make_message<odo_surface>(ODO_TYPE_SURFACE, found->t_ns);
  out.header.struct_size = size, out.header.source = found->source;
  out.id = found->id, out.kind = found->kind, out.state = ODO_SURFACE_PRESENT;
  out.count = count, out.stride = sizeof(odo_vertex), out.offset = sizeof(odo_surface);
  put(to_world(world, ODO_TIME_LATEST) * scene_.T_n_m() * found->T_m_s, out.q_n, out.p_n);
  out.sigma_m = found->sigma_m, out.tilt_sigma_rad = found->tilt_sigma_rad;
  auto* vertex = reinterpret_cast<odo_vertex*>(reinterpret_cast<char*>(&out) + out.offset);
  for (const Eigen::Vector2d& at : found->outline) {
    *vertex = {};
    Eigen::Vector2f::Map(vertex++->p) = at.cast<float>();
  }
  return ODO_OK;
}

/// Pose of the camera when it exposed the pixel's row, and the ray there.
int32_t WorldView::view_through(const odo_ray& pixel, odo_pose& camera, Vector3d& direction_c) const {
  if (pixel.camera != main_camera_()) return ODO_E_ARGUMENT;
  const auto lens = cameras_.calibration(pixel.camera);
  if (!lens) return ODO_E_NOT_FOUND;
  const auto ray =
      ray_of({(pixel.pixel[0] - lens->cx) / lens->fx, (pixel.pixel[1] - lens->cy) / lens->fy},
             lens->model == ODO_CAMERA_KANNALA_BRANDT, {lens->distortion, std::min<size_t>(lens->distortion_count, 8)});
  if (!ray) return ODO_E_ARGUMENT;
  direction_c = *ray;
  const double columns = pixel.pixel[0] - 0.5 * (lens->width - 1.0), rows = pixel.pixel[1] - 0.5 * (lens->height - 1.0);
  if (std::abs(columns) > 0.5 * lens->width + 1 || std::abs(rows) > 0.5 * lens->height + 1) return ODO_E_ARGUMENT;
  const bool rolls = (lens->header.flags & ODO_CALIBRATION_LINE_TIME) && pixel.t_ns != ODO_TIME_LATEST;
  const int64_t row_ns = rolls ? std::llround(rows * static_cast<double>(lens->line_time_ns)) : 0;
  return pose_of(ODO_OF_CAMERA, ODO_WORLD_CORRECTED, saturating_sum(pixel.t_ns, row_ns), camera);
}

/// A ray of an app in the corrected n, and the phone's pose at its time.
int32_t WorldView::ray_in_n(const odo_ray& ray, odo_pose& phone, Scene::Ray& out) const {
  Vector3d origin = Vector3d::Zero(), direction;
  int32_t status = ODO_OK;
  if (ray.kind == ODO_RAY_PIXEL) {
    status = view_through(ray, phone, direction);
  } else {
    status = poses_.at(ray.t_ns, false, phone);
    origin = Vector3d(ray.origin), direction = Vector3d(ray.direction);
  }
  if (status != ODO_OK) return status;
  if ((phone.header.flags & ODO_POSE_POSITION) == 0) return ODO_NOT_READY;
  const Rigid T = ray.kind == ODO_RAY_WORLD ? to_world(ray.world, ray.t_ns).inverse() : rigid(phone);
  out.origin_n = T * origin, out.direction_n = (T.q * direction).normalized();
  return ODO_OK;
}

int32_t WorldView::hit_test(const odo_ray& ray, std::span<odo_hit> hits, uint32_t& count) const {
  constexpr uint32_t all = ODO_HIT_SURFACE | ODO_HIT_POINT | ODO_HIT_FLOOR;
  constexpr size_t kMost = 64;  // as of the C API
  count = 0;
  if (ray.kind < ODO_RAY_PIXEL || ray.kind > ODO_RAY_WORLD || ray.world > ODO_WORLD_SMOOTH) return ODO_E_ARGUMENT;
  if (!bounds::are_numbers(ray.pixel, 2) || !bounds::are_numbers(ray.origin, 3) ||
      !bounds::are_numbers(ray.direction, 3) || !(ray.max_distance_m >= 0))
    return ODO_E_ARGUMENT;
  if (ray.kind != ODO_RAY_PIXEL && !(Vector3d(ray.direction).norm() > 0)) return ODO_E_ARGUMENT;
  const std::lock_guard lock(mutex_);  // poses and scene must belong to the same correction
  odo_pose phone{};
  Scene::Ray in_n{};
  if (const int32_t status = ray_in_n(ray, phone, in_n); status != ODO_OK) return status;
  if (!scene_.is_metric()) return ODO_NOT_READY;
  in_n.max_distance_m = ray.max_distance_m > 0 ? ray.max_distance_m : bounds::kPosition_m.high;
  in_n.wanted = ray.wanted == 0 ? all : ray.wanted;
  Scene::Hit found[kMost];
  const size_t number = scene_.cast(in_n, Vector3d(phone.p_n), found, std::min(kMost, hits.size()));
  const Rigid T_world_n = to_world(ray.world, phone.header.t_ns);
  for (size_t i = 0; i < number; ++i) {
    const Scene::Hit& hit = found[i];
    odo_hit& out = hits[i];
    out = {};
    out.what = hit.what, out.t_ns = phone.header.t_ns, out.distance_m = hit.distance_m;
    out.sigma_m = hit.sigma_m, out.scale_sigma = hit.scale_sigma;
    if (hit.surface) out.surface = hit.surface->id, out.surface_kind = hit.surface->kind;
    const Vector3d z = T_world_n.q * hit.normal_n, away = T_world_n.q * in_n.direction_n;
    Vector3d x = away - away.dot(z) * z;
    if (x.norm() < 1e-6) x = z.unitOrthogonal();
    Eigen::Matrix3d axes;
    axes << x.normalized(), z.cross(x.normalized()), z;
    put({Quaterniond(axes), T_world_n * hit.p_n}, out.q_n, out.p_n);
    Vector3d::Map(out.normal_n) = z;
  }
  count = static_cast<uint32_t>(number);
  return ODO_OK;
}

int32_t WorldView::to_geodetic(const double* p_n, double* geodetic) const {
  if (!std::all_of(p_n, p_n + 3, [](double x) { return bounds::kPosition_m.holds(x); })) return ODO_E_ARGUMENT;
  if (!geodesy_.has_origin()) return ODO_NOT_READY;
  const auto g = geodesy_.to_geodetic({p_n[0], p_n[1], p_n[2]});
  std::copy(g.begin(), g.end(), geodetic);
  return ODO_OK;
}

int32_t WorldView::from_geodetic(const double* geodetic, double* p_n) const {
  if (!bounds::kLatitude_rad.holds(geodetic[0]) || !bounds::kLongitude_rad.holds(geodetic[1]) ||
      !bounds::kPosition_m.holds(geodetic[2]))
    return ODO_E_ARGUMENT;
  if (!geodesy_.has_origin()) return ODO_NOT_READY;
  const auto p = geodesy_.from_geodetic({geodetic[0], geodetic[1], geodetic[2]});
  std::copy(p.begin(), p.end(), p_n);
  return ODO_OK;
}

}  // namespace odograph
