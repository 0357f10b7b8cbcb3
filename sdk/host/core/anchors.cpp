// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/core/anchors.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <Eigen/Eigenvalues>

#include "sdk/host/core/saved_anchor.hpp"
#include "sdk/host/messages/bounds.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/scalar.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Matrix36 = Eigen::Matrix<double, 3, 6>;

Quaterniond rotation(const double* wxyz) {
  const Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  return q.norm() > 0 ? q.normalized() : Quaterniond::Identity();
}

double largest_variance(const Matrix3d& covariance) {
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  solver.computeDirect(0.5 * (covariance + covariance.transpose()), Eigen::EigenvaluesOnly);
  const double largest = solver.eigenvalues()[2];
  return std::isfinite(largest) ? std::max(0.0, largest) : bounds::kMaxVariance;
}

std::array<double, 3> array(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d vector(const std::array<double, 3>& a) { return Vector3d(a[0], a[1], a[2]); }

/// North-East-Down axes at that point, expressed in n: over a walk the meridians converge by less than a millirad.
Quaterniond axes_at(const std::array<double, 3>& geodetic, const Geodesy& geodesy) {
  constexpr double kNorthwards_rad = 1e-6;  // 6 m
  auto north = geodetic, down = geodetic;
  north[0] += kNorthwards_rad * (geodetic[0] > 0 ? -1 : 1);  // never across a pole
  down[2] -= 1.0;
  const Vector3d here = vector(geodesy.from_geodetic(geodetic));
  const Vector3d z = (vector(geodesy.from_geodetic(down)) - here).normalized();
  const Vector3d towards = (geodetic[0] > 0 ? -1 : 1) * (vector(geodesy.from_geodetic(north)) - here);
  const Vector3d y = z.cross(towards).normalized();
  Matrix3d axes;
  axes << y.cross(z), y, z;
  return Quaterniond(axes);
}

}  // namespace

Anchors::Anchor& Anchors::add(const odo_anchor_place& place, Reference reference) {
  Anchor& anchor = anchors_.emplace_back();
  anchor.id = ++last_id_;
  anchor.kind = place.kind;
  anchor.name.assign(place.name.data ? place.name.data : "", place.name.size);
  anchor.reference = reference;
  anchor.smooth = SmoothPose(p_.smooth);
  anchor.q = rotation(place.q);
  return anchor;
}

uint64_t Anchors::add_local(const odo_anchor_place& place, const Placement& placement) {
  const std::lock_guard lock(mutex_);
  if (anchors_.size() >= p_.max_anchors) return 0;
  Anchor& anchor = add(place, placement.on_surface ? Reference::surface : Reference::awaiting_pose);
  anchor.placed = true;
  anchor.surface = placement.on_surface ? place.surface : 0;
  anchor.T_n_a = placement.T_n_a;
  anchor.T_b_a = placement.T_n_b.inverse() * placement.T_n_a;
  anchor.seen_ns = placement.t_ns, anchor.sigma_m = placement.sigma_m, anchor.hit_sigma_m = placement.hit_sigma_m;
  return anchor.id;
}

uint64_t Anchors::add_geodetic(const odo_anchor_place& place) {
  const std::lock_guard lock(mutex_);
  if (anchors_.size() >= p_.max_anchors) return 0;
  Anchor& anchor = add(place, Reference::geodetic);
  const double geoid_m = place.height_above == ODO_HEIGHT_GEOID ? place.geoid_height_m : 0.0;
  anchor.geodetic = {place.latitude_rad, place.longitude_rad, place.height_m + geoid_m};
  anchor.height_above = place.height_above;
  anchor.sigma_m = place.sigma_m;
  anchor.lost_reason = ODO_REASON_NO_FIX;
  return anchor.id;
}

bool Anchors::remove(uint64_t id) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(anchors_.begin(), anchors_.end(), [id](const Anchor& a) { return a.id == id; });
  if (found == anchors_.end()) return false;
  removed_ = true;
  anchors_.erase(found);
  return true;
}

std::vector<uint64_t> Anchors::ids() const {
  const std::lock_guard lock(mutex_);
  std::vector<uint64_t> ids;
  for (const Anchor& anchor : anchors_) ids.push_back(anchor.id);
  return ids;
}

std::optional<Anchors::State> Anchors::get(uint64_t id, int64_t t_ns, bool drawn) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(anchors_.begin(), anchors_.end(), [id](const Anchor& a) { return a.id == id; });
  if (found == anchors_.end()) return std::nullopt;
  const Anchor& anchor = *found;
  if (drawn) queried_ns_ = std::max(queried_ns_, t_ns);
  State state;
  state.anchor.kind = anchor.kind;
  state.anchor.id = anchor.id;
  anchor.name.copy(state.anchor.name, kLongestName);
  state.anchor.state = anchor.placed ? ODO_TRACKING : ODO_LOST;
  state.anchor.reason = anchor.placed ? ODO_REASON_NONE : anchor.lost_reason;
  state.T_n_a = anchor.T_n_a;
  const auto smooth = anchor.smooth.at(t_ns, {anchor.T_n_a.q, anchor.T_n_a.p});
  state.smooth_T_n_a = {smooth.q_n, smooth.p_n};
  if (anchor.reference == Reference::geodetic && anchor.height_above != ODO_HEIGHT_TERRAIN)
    state.geodetic = anchor.geodetic;
  else if (anchor.placed && placed_ && geodesy_.has_origin())
    state.geodetic = geodesy_.to_geodetic(array(anchor.T_n_a.p));
  const Covariance covariance = covariance_of(anchor);
  state.position_variance = largest_variance(covariance.place);
  state.view_variance = largest_variance(covariance.view);
  state.yaw_variance = covariance.yaw_variance;
  return state;
}

void Anchors::georeference(Anchor& anchor, const KeptPose& now) {
  if (anchor.placed) return;
  anchor.lost_reason = !placed_ ? ODO_REASON_NO_FIX : ODO_REASON_NO_ORIGIN;
  if (!placed_ || !geodesy_.has_origin()) return;
  auto place = anchor.geodetic;
  Vector3d p_n = vector(geodesy_.from_geodetic(place));
  if (anchor.height_above == ODO_HEIGHT_TERRAIN) {
    anchor.lost_reason = ODO_REASON_NO_GROUND;
    // The horizontal position of a latitude and longitude depends on the height by only a millionth of it.
    place[2] = geodesy_.to_geodetic(array(now.p_n_b))[2];
    p_n = vector(geodesy_.from_geodetic(place));
    const auto down_m = ground_ ? ground_(p_n.x(), p_n.y(), now.p_n_b.z()) : std::nullopt;
    if (!down_m) return;
    p_n.z() = *down_m - anchor.geodetic[2];
  }
  anchor.T_n_a = {(axes_at(place, geodesy_) * anchor.q).normalized(), p_n};
  anchor.smooth.reset();
  anchor.placed = true;
  anchor.lost_reason = 0;
}

void Anchors::attach_to_pose(Anchor& anchor, KeptPoses& poses) {
  const Attachment body = poses.keep_pose(anchor.seen_ns);
  take_hand_overs(poses);
  KeptPose kept;
  if (body.pose_id == 0 || !poses.kept_pose(body.pose_id, kept)) return;
  anchor.to_pose = attach(body, anchor.T_b_a, kept.q_n_b);
  anchor.reference = Reference::pose;
}

void Anchors::take_hand_overs(KeptPoses& poses) {
  for (const HandOver& hand_over : poses.take_hand_overs()) {
    for (Anchor& anchor : anchors_) hand_over.apply(anchor.to_pose);
    poses_.erase(hand_over.from);
  }
}

/// Once its map is recognised, an anchor is fixed to the frame of that.
void Anchors::find_map(Anchor& anchor, const KeptPoses& poses) {
  const uint64_t frame = poses.map_frame(anchor.map_source, anchor.map);
  if (frame == 0) return;
  anchor.to_pose = {frame, anchor.T_b_a, Eigen::Matrix4d::Zero()};
  anchor.reference = Reference::pose;
  anchor.placed = true, anchor.lost_reason = 0;
}

/// With l from the body to the anchor and s from the kept pose to it, the position error is dp_h - s x theta_h, and the
/// error in the view is that - dp + l x theta.
Anchors::Covariance Anchors::covariance_of(const Anchor& anchor) const {
  Matrix36 by_now;
  by_now << skew(anchor.T_n_a.p - now_.p_n_b), -Matrix3d::Identity();
  const Matrix3d of_view = by_now * now_.now * by_now.transpose();
  Matrix3d own = Matrix3d::Identity() * (squared(anchor.sigma_m) + squared(anchor.hit_sigma_m));
  const KeptPose* kept = poses_.find(anchor.to_pose.pose_id);
  if (anchor.reference == Reference::surface) {
    own += Matrix3d::Identity() * squared(p_.surface_drift) * (anchor.T_n_a.p - now_.p_n_b).squaredNorm();
    return {of_view + own, own, now_.now(2, 2)};
  }
  if (anchor.reference == Reference::awaiting_pose) return {of_view + own, own, now_.now(2, 2)};  // seen from there
  if (!kept) return {own, of_view + own, 0};
  const auto relative = covariance_on(*kept, anchor.to_pose, anchor.T_n_a.p, now_);
  return {relative.place + own, relative.view + own, kept->own(2, 2)};
}

void Anchors::update(KeptPoses& poses, int64_t t_ns, const Rigid* correction) {
  const std::lock_guard lock(mutex_);
  placed_ = placed_ || poses.is_placed();
  take_hand_overs(poses);
  if (std::exchange(removed_, false))
    poses_.release_unused(poses, [this](uint64_t id) {
      return std::any_of(anchors_.begin(), anchors_.end(),
                         [id](const Anchor& anchor) { return anchor.to_pose.pose_id == id; });
    });
  if (anchors_.empty() || !poses.pose_now(now_)) return;
  now_ns_ = t_ns;
  poses_.update(poses);
  for (Anchor& anchor : anchors_) {
    const bool was_placed = anchor.placed, stays = stays_in_n(anchor.reference);
    const Rigid before = correction ? *correction * anchor.T_n_a : anchor.T_n_a;
    if (anchor.reference == Reference::awaiting_pose) attach_to_pose(anchor, poses);
    if (anchor.reference == Reference::map) find_map(anchor, poses);
    if (anchor.reference == Reference::pose && !poses_.add(anchor.to_pose.pose_id, poses))
      anchor.reference = Reference::track, anchor.to_pose.pose_id = 0;
    if (const KeptPose* kept = poses_.find(anchor.to_pose.pose_id))
      anchor.T_n_a = Rigid{kept->q_n_b, kept->p_n_b} * anchor.to_pose.T_kept_x;
    else if (!stays)
      anchor.T_n_a = before;
    if (anchor.reference == Reference::geodetic) georeference(anchor, now_);
    if (anchor.reference == Reference::navigation && placed_) anchor.placed = true, anchor.lost_reason = 0;
    if (was_placed) blend(anchor, before, t_ns);
  }
}

void Anchors::follow_surface(uint64_t id, uint64_t into, const Rigid& T_n_s, double sigma_m) {
  const std::lock_guard lock(mutex_);
  for (Anchor& anchor : anchors_) {
    if (anchor.surface != id) continue;
    const Rigid before = anchor.T_n_a;
    if (into != id)
      anchor.T_b_a = T_n_s.inverse() * before, anchor.surface = into;
    else
      anchor.T_n_a = T_n_s * anchor.T_b_a;
    anchor.sigma_m = sigma_m;
    blend(anchor, before, now_ns_);
  }
}

void Anchors::leave_surface(uint64_t id) {
  const std::lock_guard lock(mutex_);
  for (Anchor& anchor : anchors_) {
    if (anchor.surface != id) continue;
    anchor.surface = 0, anchor.kind = ODO_ANCHOR_POSE, anchor.sigma_m = 0;
    anchor.reference = Reference::awaiting_pose, anchor.seen_ns = now_ns_;
    anchor.T_b_a = Rigid{now_.q_n_b, now_.p_n_b}.inverse() * anchor.T_n_a;
  }
}

/// In the smooth world a placed anchor moves from `before` to where it is.
void Anchors::blend(Anchor& anchor, const Rigid& before, int64_t t_ns) {
  const Rigid moved = before.inverse() * anchor.T_n_a;
  if (moved.p.norm() > p_.max_smooth_jump_m || moved.q.vec().norm() > p_.max_smooth_jump_m)
    anchor.smooth.jumped(std::max(t_ns, queried_ns_), {before.q, before.p}, {anchor.T_n_a.q, anchor.T_n_a.p});
}

void Anchors::drop_kept_poses() {
  const std::lock_guard lock(mutex_);
  placed_ = false;
  queried_ns_ = INT64_MIN;  // the sensor clock was set back
  poses_.clear();
  for (Anchor& anchor : anchors_) {
    if (anchor.reference == Reference::pose || anchor.reference == Reference::awaiting_pose)
      anchor.reference = Reference::track;
    anchor.to_pose.pose_id = 0;
    anchor.smooth.reset();
  }
}

std::vector<uint8_t> Anchors::save() const {
  const std::lock_guard lock(mutex_);
  std::vector<uint8_t> bytes;
  for (const Anchor& anchor : anchors_) {
    SavedAnchor saved{};
    // A later session does not have this one's surfaces.
    saved.kind = anchor.kind == ODO_ANCHOR_HIT ? ODO_ANCHOR_POSE : anchor.kind,
    saved.height_above = anchor.height_above, saved.sigma_m = anchor.sigma_m;
    anchor.name.copy(saved.name, kLongestName);
    Quaterniond q = anchor.T_n_a.q;
    if (anchor.reference == Reference::geodetic) {
      saved.reference = kSavedGeodetic;
      std::copy(anchor.geodetic.begin(), anchor.geodetic.end(), saved.geodetic);
      q = anchor.q;
    } else if (!placed_ || anchor.reference == Reference::map) {
      continue;  // a later session could not place it
    } else if (geodesy_.has_origin()) {
      saved.reference = kSavedGeodetic;
      const auto geodetic = geodesy_.to_geodetic(array(anchor.T_n_a.p));
      std::copy(geodetic.begin(), geodetic.end(), saved.geodetic);
      q = axes_at(geodetic, geodesy_).conjugate() * q;
      saved.sigma_m = std::sqrt(largest_variance(covariance_of(anchor).place));
    } else {
      saved.reference = kSavedNavigation;
      Vector3d::Map(saved.p) = anchor.T_n_a.p;
      saved.sigma_m = std::sqrt(largest_variance(covariance_of(anchor).place));
    }
    put_quaternion(q, saved.q);
    const auto* from = reinterpret_cast<const uint8_t*>(&saved);
    bytes.insert(bytes.end(), from, from + sizeof saved);
  }
  return bytes;
}

std::vector<uint8_t> Anchors::save_in(const std::optional<Rigid>& T_n_m, uint32_t source, uint64_t map) const {
  const std::lock_guard lock(mutex_);
  const Rigid T_m_n = T_n_m ? T_n_m->inverse() : Rigid();
  std::vector<uint8_t> bytes;
  for (const Anchor& anchor : anchors_) {
    SavedAnchor saved{};
    saved.kind = ODO_ANCHOR_POSE, saved.reference = kSavedNavigation;
    anchor.name.copy(saved.name, kLongestName);
    Rigid T_m_a = T_m_n * anchor.T_n_a;
    if (anchor.reference == Reference::map && anchor.map_source == source && anchor.map == map)
      T_m_a = anchor.T_b_a;  // not recognised in this session
    else if (!T_n_m || !anchor.placed || anchor.reference == Reference::geodetic)
      continue;
    put_quaternion(T_m_a.q, saved.q);
    Vector3d::Map(saved.p) = T_m_a.p;
    saved.sigma_m = std::hypot(anchor.sigma_m, anchor.hit_sigma_m);
    const auto* from = reinterpret_cast<const uint8_t*>(&saved);
    bytes.insert(bytes.end(), from, from + sizeof saved);
  }
  return bytes;
}

Anchors::Anchor& Anchors::add(const SavedAnchor& saved, Reference reference) {
  odo_anchor_place place{};
  place.kind = saved.kind, place.name = {saved.name, std::strlen(saved.name)};
  std::copy(saved.q, saved.q + 4, place.q);
  Anchor& anchor = add(place, reference);
  anchor.sigma_m = saved.sigma_m, anchor.lost_reason = ODO_REASON_NO_FIX;
  return anchor;
}

bool Anchors::load(std::span<const uint8_t> blob) {
  const auto all = saved_anchors_of(blob);
  const std::lock_guard lock(mutex_);
  if (!all || anchors_.size() + all->size() > p_.max_anchors) return false;
  for (const SavedAnchor& saved : *all) {
    Anchor& anchor = add(saved, saved.reference == kSavedGeodetic ? Reference::geodetic : Reference::navigation);
    std::copy(saved.geodetic, saved.geodetic + 3, anchor.geodetic.begin());
    anchor.T_n_a = {anchor.q, Vector3d(saved.p)};
    anchor.height_above = saved.height_above;
  }
  return true;
}

bool Anchors::load_in(std::span<const uint8_t> blob, uint32_t source, uint64_t map) {
  const auto all = saved_anchors_of(blob);
  const std::lock_guard lock(mutex_);
  if (!all || anchors_.size() + all->size() > p_.max_anchors) return false;
  for (const SavedAnchor& saved : *all) {
    const auto same = [&](const Anchor& anchor) { return anchor.name == saved.name; };
    if (saved.name[0] != 0 && std::any_of(anchors_.begin(), anchors_.end(), same)) continue;
    Anchor& anchor = add(saved, Reference::map);
    anchor.map_source = source, anchor.map = map, anchor.T_b_a = {anchor.q, Vector3d(saved.p)};
  }
  return true;
}

}  // namespace odograph
