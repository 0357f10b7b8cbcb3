// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/camera/point_tracks.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void PointTracks::move(const Eigen::Quaterniond& q_c0_c1, const Vector3d& p_c0_c1) {
  T_w_c_.translation() += T_w_c_.linear() * p_c0_c1;
  T_w_c_.linear() = (Eigen::Quaterniond(T_w_c_.linear()) * q_c0_c1).normalized().toRotationMatrix();
}

const std::vector<TrackedPoint>& PointTracks::see(const std::vector<TrackedCorner>& corners, double sigma_rad) {
  ++frame_;
  points_.clear();
  for (const TrackedCorner& corner : corners) {
    Track& track = tracks_[corner.id];
    ++track.age;
    track.seen_in = frame_;
    add(track, {T_w_c_ * corner.origin_c, (T_w_c_.linear() * corner.ray_c).normalized()});
    locate(track, sigma_rad);
    if (!track.located) continue;
    points_.push_back(in_camera(corner.id, track));
    points_.back().pixel = corner.pixel;
    points_.back().used = corner.used;
  }
  for (auto entry = tracks_.begin(); entry != tracks_.end();) {
    const auto& [id, track] = *entry;
    if (track.seen_in == frame_) {
      ++entry;
      continue;
    }
    if (track.located) {
      points_.push_back(in_camera(id, track));
      points_.back().lost = true;
    }
    entry = tracks_.erase(entry);
  }
  return points_;
}

/// A ray that is nearly parallel to the newest from nearly the same place carries no new information on the distance.
void PointTracks::add(Track& track, const Ray& ray) const {
  auto& rays = track.rays;
  if (rays.size() > 1) {
    const Ray& before = rays[rays.size() - 2];
    const double distance = track.located ? (track.X_w - ray.origin_w).norm() : 0;
    const bool near = track.located ? (ray.origin_w - before.origin_w).norm() < p_.min_angle_rad * distance
                                    : before.direction_w.cross(ray.direction_w).norm() < p_.min_angle_rad;
    if (near) rays.pop_back();
  }
  if (rays.size() == p_.rays) rays.erase(rays.begin() + 1);
  rays.push_back(ray);
}

void PointTracks::locate(Track& track, double sigma_rad) const {
  const auto& rays = track.rays;
  double least = 1;  // cosine of the largest angle
  for (const Ray& ray : rays) least = std::min(least, rays.front().direction_w.dot(ray.direction_w));
  const bool was_located = track.located;
  track.located = false;
  if (least > std::cos(p_.min_parallax_rad)) return;
  Vector3d X = track.X_w;
  Matrix3d A = Matrix3d::Identity();
  for (int iteration = was_located ? p_.iterations - 1 : 0; iteration < p_.iterations; ++iteration) {
    const bool weighted = was_located || iteration > 0;
    A.setZero();
    Vector3d b = Vector3d::Zero();
    for (const Ray& ray : rays) {
      const double distance = weighted ? (X - ray.origin_w).norm() : 1;
      const Matrix3d across = (Matrix3d::Identity() - ray.direction_w * ray.direction_w.transpose()) /
                              std::pow(std::max(distance, 1e-9) * sigma_rad, 2);
      A += across, b += across * ray.origin_w;
    }
    X = A.ldlt().solve(b);
  }
  double chi2 = 0;
  for (const Ray& ray : rays) {
    const Vector3d to = X - ray.origin_w;
    if (!(to.dot(ray.direction_w) > 0)) return;
    chi2 += std::pow(to.cross(ray.direction_w).norm() / (to.norm() * sigma_rad), 2);
  }
  const double per_dof = chi2 / (2.0 * static_cast<double>(rays.size()) - 3);
  if (!(per_dof < p_.max_chi2)) return;
  track.X_w = X;
  track.covariance_w = std::max(1.0, per_dof) * A.inverse();
  const Vector3d to = X - rays.back().origin_w;
  track.uncertain = std::sqrt(to.dot(track.covariance_w * to)) > p_.uncertain * to.squaredNorm();
  track.located = track.covariance_w.allFinite();
}

TrackedPoint PointTracks::in_camera(uint64_t id, const Track& track) const {
  TrackedPoint point;
  point.id = id;
  point.p_c = T_w_c_.linear().transpose() * (track.X_w - T_w_c_.translation());
  point.covariance = T_w_c_.linear().transpose() * track.covariance_w * T_w_c_.linear();
  point.age = track.age;
  point.uncertain = track.uncertain;
  return point;
}

}  // namespace odograph
