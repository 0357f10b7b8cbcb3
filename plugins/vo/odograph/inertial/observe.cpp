// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/observe.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "plugins/vo/odograph/visual/gyroscope.hpp"

namespace odograph::vio {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using vo::cross_matrix;
using vo::exp_rotation;

constexpr double kNearest_m = 0.05;
constexpr int kIterations = 8;
constexpr double kSettled = 1e-4;  // relative change of a point

Eigen::Quaterniond row_rotation(const Clone& c, double dt) {
  return exp_rotation(dt * c.rate_c + 0.5 * dt * dt * c.rate_change_c);
}

/// By the lens with another focal length.
Projection zoomed(Projection p, const CameraModel& lens, double focal_px) {
  const double by = focal_px / lens.focal();
  const Vector2d centre(lens.cx, lens.cy);
  p.pixel = centre + by * (p.pixel - centre);
  p.by_point *= by;
  p.by_lens.col(0) *= by;
  p.by_lens.rightCols<2>() *= by;
  return p;
}

}  // namespace

std::optional<Observed> observe(const Clone& c, const Camera& camera, const Vector3d& p_w, double row) {
  const double rows = row - camera.middle_row, dt = rows * camera.line_time_s;
  const Matrix3d R_c_w = (c.q_w_c * row_rotation(c, dt)).conjugate().toRotationMatrix();
  const Vector3d y = R_c_w * (p_w - c.p_w - dt * c.v_w - 0.5 * dt * dt * c.a_w);
  if (y.z() < kNearest_m) return std::nullopt;
  const Projection projection = zoomed(project(camera.lens, y), camera.lens, c.focal_px);
  Observed out;
  out.pixel = projection.pixel + c.shift_px + dt * c.shift_rate_px_s;
  out.by_follow = dt * c.drive_px_s;
  out.by_lens = projection.by_lens;
  out.by_lens.col(0).setZero();
  out.by_point = projection.by_point * R_c_w;
  const Vector3d by_time = y.cross(c.rate_c + dt * c.rate_change_c) - R_c_w * (c.v_w + dt * c.a_w);
  out.by_line_time = rows * (projection.by_point * by_time + c.shift_rate_px_s);
  out.by_clone << out.by_point * cross_matrix(p_w), -out.by_point, Eigen::Matrix2d::Identity(),
      projection.by_lens.col(0);
  out.depth_m = y.z();
  return out;
}

Vector3d ray_of(const Clone& c, const Camera& camera, const Vector2d& pixel, double row) {
  thread_local std::vector<cv::Point2f> one(1);
  thread_local std::vector<cv::Point2d> straight(1);
  const double dt = (row - camera.middle_row) * camera.line_time_s;
  const Vector2d centre(camera.lens.cx, camera.lens.cy);
  const Vector2d unshifted =
      centre + (camera.lens.focal() / c.focal_px) * (pixel - c.shift_px - dt * c.shift_rate_px_s - centre);
  one[0] = {static_cast<float>(unshifted.x()), static_cast<float>(unshifted.y())};
  camera.lens.undistort(one, straight);
  const Vector3d ray = row_rotation(c, dt) * Vector3d(straight[0].x, straight[0].y, 1);
  return ray / ray.z();
}

std::optional<Triangulated> triangulate(const State& state, const std::vector<Observation>& track,
                                        const FilterParameters& p) {
  struct View {
    const Clone* clone;
    Vector3d ray_w;
  };
  std::vector<View> views;
  for (const Observation& o : track) {
    const Clone& c = state.clones[state.find_clone(o.clone)];
    views.push_back({&c, (c.q_w_c * ray_of(c, state.camera, o.pixel, o.row)).normalized()});
  }
  Triangulated out;
  const View& first = views.front();
  const View* other = nullptr;
  double widest = 0;
  for (const View& view : views) {
    const double angle = std::atan2(first.ray_w.cross(view.ray_w).norm(), first.ray_w.dot(view.ray_w));
    if (angle > widest) widest = angle, other = &view;
  }
  out.parallax_rad = widest;
  const Vector3d ray = ray_of(*first.clone, state.camera, track.front().pixel, track.front().row);
  out.at = Vector3d(ray.x(), ray.y(), p.inverse_depth);
  if (other && widest > 0.5 * p.least_parallax_rad) {
    const Vector3d b = other->clone->p_w - first.clone->p_w;
    const Vector3d across = first.ray_w.cross(other->ray_w);
    const double range = b.cross(other->ray_w).dot(across) / across.squaredNorm();
    const double depth = range / ray.norm();
    if (depth > kNearest_m) out.at.z() = 1 / depth;
  }
  const Matrix3d R = first.clone->q_w_c.toRotationMatrix();
  double before = INFINITY, damping = 1e-3;
  Vector3d best = out.at;
  Matrix3d H = Matrix3d::Zero();
  Vector3d g = Vector3d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double sum = 0;
    Matrix3d H_now = Matrix3d::Zero();
    Vector3d g_now = Vector3d::Zero();
    const Vector3d p_w = first.clone->p_w + R * landmark_ray(out.at);
    const Matrix3d J_point = R * landmark_jacobian(out.at);
    bool seen = true;
    for (size_t i = 0; i < track.size() && seen; ++i) {
      const auto o = observe(*views[i].clone, state.camera, p_w, track[i].row);
      seen = o.has_value();
      if (!seen) break;
      const Vector2d error = track[i].pixel - o->pixel;
      const Eigen::Matrix<double, 2, 3> J = o->by_point * J_point;
      sum += error.squaredNorm();
      H_now += J.transpose() * J;
      g_now += J.transpose() * error;
    }
    if (!seen) sum = INFINITY;
    if (sum < before) {
      const bool settled = before - sum < kSettled * before;
      best = out.at, H = H_now, g = g_now;
      before = sum;
      damping *= 0.1;
      if (settled) break;
    } else if (std::isinf(before)) {
      return std::nullopt;
    } else {
      damping *= 10;
    }
    Matrix3d damped = H;
    damped.diagonal() *= 1 + damping;
    damped(2, 2) += 1e-9;
    out.at = best + damped.ldlt().solve(g);
    out.at.z() = std::max(out.at.z(), 1e-4);
  }
  out.at = best;
  out.rms_px = std::sqrt(before / static_cast<double>(track.size()));
  return out;
}

}  // namespace odograph::vio
