// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/object_fixer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sdk/math/time.hpp"

namespace odograph::known_object {

using Eigen::Quaterniond;
using Eigen::Vector3d;

ObjectFixer::ObjectFixer(const Parameters& parameters, const Finder::Parameters& finder,
                         const SightingValidator::Parameters& validator, std::vector<PlaneObject> objects)
    : p_(parameters), finder_(finder, on_map(std::move(objects))), validator_(validator) {
  reset();
}

void ObjectFixer::reset() {
  finder_.clear();
  validator_.clear();
  poses_.clear(), waiting_.clear();
  has_mount_ = false;
  // The positions are in n from the start for local objects, and for geodetic ones if the origin is known.
  is_map_aligned_ = !any_geodetic_ || p_.origin;
  placed_ = p_.always_placed && is_map_aligned_;
  n_from_map_.setZero();
  fix_on_map_.reset(), gnss_.reset();
}

void ObjectFixer::set_mount(const Quaterniond& q_b_c, const Vector3d& p_b_c) {
  q_b_c_ = q_b_c, p_b_c_ = p_b_c;
  has_mount_ = true;
}

void ObjectFixer::add_gnss(int64_t t_ns, double latitude_rad, double longitude_rad, std::optional<double> sigma_m) {
  if (!any_geodetic_) return;
  gnss_ = GnssPosition{t_ns, on_map(latitude_rad, longitude_rad, datum_[2]),
                       p_.gnss_m + p_.gnss_sigmas * sigma_m.value_or(p_.gnss_sigma_m)};
}

std::vector<Estimate> ObjectFixer::add_pose(const PipelinePose& pose) {
  while (!poses_.empty() && poses_.back().t_ns >= pose.t_ns) poses_.pop_back();
  poses_.push_back(pose);
  while (pose.t_ns - poses_.front().t_ns > p_.keep_ns) poses_.pop_front();
  align_map(pose);
  return decide();
}

std::vector<Estimate> ObjectFixer::add_frame(int64_t t_ns, const cv::Mat& grey, const cv::Mat& mask, RollingLens lens) {
  set_motion(lens);
  for (Sighting& s : finder_.find(t_ns, grey, mask, lens, possible())) waiting_.push_back({std::move(s), lens});
  return decide();
}

/// Converts geodetic objects to positions on a map: n if its origin is known, otherwise north, east, down about the
/// first of them.
std::vector<PlaneObject> ObjectFixer::on_map(std::vector<PlaneObject> objects) {
  for (const PlaneObject& o : objects) {
    if (!o.place.geodetic || any_geodetic_) continue;
    any_geodetic_ = true;
    datum_ = {o.place.latitude_rad, o.place.longitude_rad, o.place.height_m};
  }
  datum_ = p_.origin.value_or(datum_);
  for (PlaneObject& o : objects) {
    if (any_geodetic_ && !o.place.geodetic && !p_.origin)
      throw std::runtime_error("object '" + o.id +
                               "' has its position in n, others have geodetic positions: set geodetic_origin");
    if (o.place.geodetic) o.place.p_n = on_map(o.place.latitude_rad, o.place.longitude_rad, o.place.height_m);
  }
  return objects;
}

Vector3d ObjectFixer::on_map(double latitude_rad, double longitude_rad, double height_m) const {
  const RadianLengths metres(datum_[0]);
  const double east_rad = std::remainder(longitude_rad - datum_[1], 2 * std::numbers::pi);
  return {(latitude_rad - datum_[0]) * metres.north_m, east_rad * metres.east_m, datum_[2] - height_m};
}

/// Determines n on the map of objects without a known origin, from the first pose after a fix.
void ObjectFixer::align_map(const PipelinePose& pose) {
  if (!fix_on_map_ || !pose.is_metric_position) return;
  if (!is_map_aligned_) n_from_map_ = pose.p_n - *fix_on_map_;
  placed_ = true;
  fix_on_map_.reset();
}

/// Angular rate and velocity of the camera, from the two newest poses.
void ObjectFixer::set_motion(RollingLens& lens) const {
  lens.rate_c.setZero(), lens.velocity_c.setZero();
  if (poses_.size() < 2) return;
  const PipelinePose &a = poses_[poses_.size() - 2], &b = poses_.back();
  const double dt_s = seconds(b.t_ns - a.t_ns);
  if (dt_s < p_.min_motion_s || dt_s > p_.max_motion_s) return;
  lens.rate_c = log_rotation(camera(a).conjugate() * camera(b)) / dt_s;
  if (b.velocity_n) lens.velocity_c = camera(b).conjugate() * *b.velocity_n;
}

Quaterniond ObjectFixer::camera(const PipelinePose& pose) const {
  return pose.is_of_camera ? pose.q_n : (pose.q_n * q_b_c_).normalized();
}

Prior ObjectFixer::prior_of(const PipelinePose& pose) const {
  Prior p;
  p.q_n_c = camera(pose);
  p.p_n = pose.p_n - n_from_map_;
  if (!pose.is_of_camera) p.p_n += p.q_n_c * (q_b_c_.conjugate() * p_b_c_);
  p.tilt_sigma_rad = std::min(pose.tilt_sigma_rad, p_.max_tilt_sigma_rad), p.yaw_sigma_rad = pose.yaw_sigma_rad;
  p.horizontal_sigma_m = pose.horizontal_sigma_m, p.vertical_sigma_m = pose.vertical_sigma_m;
  p.path_m = pose.path_m;
  p.placed = placed_ && pose.is_metric_position;
  if (!p.placed && gnss_ && std::abs(pose.t_ns - gnss_->t_ns) < p_.fresh_ns)
    p.p_n = gnss_->p_map, p.coarse_error_m = gnss_->accuracy_m;
  return p;
}

/// Prior at a frame's time: a pose at that time, or interpolated between two poses.
std::optional<Prior> ObjectFixer::prior_at(int64_t t_ns) const {
  for (size_t k = poses_.size(); k-- > 0;) {
    const PipelinePose& before = poses_[k];
    if (before.t_ns == t_ns) return prior_of(before);
    if (before.t_ns > t_ns) continue;
    if (k + 1 == poses_.size()) return {};
    const PipelinePose& after = poses_[k + 1];
    const double all = static_cast<double>(after.t_ns - before.t_ns);
    const double part = static_cast<double>(t_ns - before.t_ns) / all;
    if (all > p_.max_between_ns) return {};
    Prior p = prior_of(part < 0.5 ? before : after);
    p.q_n_c = camera(before).slerp(part, camera(after));
    return p;
  }
  return {};
}

/// For each object, whether it may be in view.
std::vector<char> ObjectFixer::possible() const {
  const auto& all = finder_.objects();
  std::vector<char> result(all.size(), 1);
  if (poses_.empty() || !has_mount_) return result;
  const Prior p = prior_of(poses_.back());
  if (!p.placed && p.coarse_error_m <= 0) return result;
  const double off_m =
      p.placed ? p_.off_sigmas * p.horizontal_sigma_m + p_.off_m + p_.drift * p.path_m : p.coarse_error_m;
  for (size_t k = 0; k < all.size(); ++k) {
    const Vector3d to = all[k].place.p_n - p.p_n;
    result[k] = to.head<2>().norm() < p_.range_m + off_m && all[k].place.R_n_o.col(2).dot(to) > -off_m;
  }
  return result;
}

std::vector<Estimate> ObjectFixer::decide() {
  std::deque<Waiting> still;
  std::vector<Estimate> fixes;
  for (Waiting& w : waiting_) {
    const int64_t t_ns = w.sighting.t_ns;
    auto p = prior_at(t_ns);
    const bool late = !poses_.empty() && poses_.back().t_ns - t_ns > p_.patience_ns;
    if (!p && !poses_.empty() && std::abs(poses_.back().t_ns - t_ns) < p_.near_ns && waiting_.size() > p_.waiting)
      p = prior_of(poses_.back());
    if (!p) {
      if (!late && still.size() < p_.max_waiting) still.push_back(std::move(w));
      continue;
    }
    if (auto estimate = validator_.validate(w.sighting, object(w.sighting.object), w.lens, *p))
      fixes.push_back(*estimate);
  }
  waiting_ = std::move(still);
  if (!fixes.empty()) fix_on_map_ = fixes.back().p_n;
  return fixes;
}

}  // namespace odograph::known_object
