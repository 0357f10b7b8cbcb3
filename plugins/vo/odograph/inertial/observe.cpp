// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/observe.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "sdk/math/rotation.hpp"

namespace odograph::vio {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNearest_m = 0.05;  // min depth of a point: no phone's lens focuses nearer

Eigen::Quaterniond row_rotation(const Clone& c, double dt) {
  return exp_rotation(dt * c.rate_c + 0.5 * dt * dt * c.rate_change_c);
}

/// Projection by the lens with another focal length.
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
  out.by_gain = dt * c.drive_px_s;
  out.by_lens = projection.by_lens;
  out.by_lens.col(0).setZero();
  out.by_point = projection.by_point * R_c_w;
  const Vector3d by_time = y.cross(c.rate_c + dt * c.rate_change_c) - R_c_w * (c.v_w + dt * c.a_w);
  out.by_line_time = rows * (projection.by_point * by_time + c.shift_rate_px_s);
  out.by_clone << out.by_point * skew(p_w), -out.by_point, Eigen::Matrix2d::Identity(), projection.by_lens.col(0);
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

namespace {

/// Initial estimate of a track's point: its ray in the first clone, with the depth from the ray of largest parallax.
Triangulated first_guess(const State& state, const std::vector<Observation>& track,
                         const std::vector<const Clone*>& clones, const FilterParameters& p) {
  std::vector<Vector3d> rays_w;
  for (size_t i = 0; i < track.size(); ++i)
    rays_w.push_back((clones[i]->q_w_c * ray_of(*clones[i], state.camera, track[i].pixel, track[i].row)).normalized());
  Triangulated out;
  size_t other = 0;
  for (size_t i = 0; i < track.size(); ++i) {
    const double angle = std::atan2(rays_w[0].cross(rays_w[i]).norm(), rays_w[0].dot(rays_w[i]));
    if (angle > out.parallax_rad) out.parallax_rad = angle, other = i;
  }
  const Vector3d ray = ray_of(*clones[0], state.camera, track.front().pixel, track.front().row);
  out.at = Vector3d(ray.x(), ray.y(), p.inverse_depth);
  if (out.parallax_rad > 0.5 * p.min_parallax_rad) {
    const Vector3d b = clones[other]->p_w - clones[0]->p_w;
    const Vector3d across = rays_w[0].cross(rays_w[other]);
    const double range = b.cross(rays_w[other]).dot(across) / across.squaredNorm();
    const double depth = range / ray.norm();
    if (depth > kNearest_m) out.at.z() = 1 / depth;
  }
  return out;
}

/// Gauss-Newton equations of a point at its present estimate. Nothing if the point is behind a clone.
struct PointEquations {
  Matrix3d H = Matrix3d::Zero();
  Vector3d g = Vector3d::Zero();
  double sum = 0;  ///< of squared errors, px^2
};
std::optional<PointEquations> point_equations(const Camera& camera, const std::vector<Observation>& track,
                                              const std::vector<const Clone*>& clones, const Vector3d& at) {
  PointEquations e;
  const Matrix3d R = clones[0]->q_w_c.toRotationMatrix();
  const Vector3d p_w = clones[0]->p_w + R * landmark_ray(at);
  const Matrix3d J_point = R * landmark_jacobian(at);
  for (size_t i = 0; i < track.size(); ++i) {
    const auto o = observe(*clones[i], camera, p_w, track[i].row);
    if (!o) return std::nullopt;
    const Vector2d error = track[i].pixel - o->pixel;
    const Eigen::Matrix<double, 2, 3> J = o->by_point * J_point;
    e.sum += error.squaredNorm();
    e.H += J.transpose() * J;
    e.g += J.transpose() * error;
  }
  return e;
}

}  // namespace

std::optional<Triangulated> triangulate(const State& state, const std::vector<Observation>& track,
                                        const FilterParameters& p) {
  std::vector<const Clone*> clones;
  for (const Observation& o : track) clones.push_back(&state.clones[state.find_clone(o.clone)]);
  Triangulated out = first_guess(state, track, clones, p);
  Vector3d best = out.at;
  std::optional<PointEquations> now;  // at the best estimate
  double damping = p.triangulation.damping;
  for (int iteration = 0; iteration < p.triangulation.iterations; ++iteration) {
    const auto e = point_equations(state.camera, track, clones, out.at);
    if (e && e->sum < (now ? now->sum : INFINITY)) {
      const bool settled = now && now->sum - e->sum < p.triangulation.settled * now->sum;
      best = out.at, now = e;
      damping *= 0.1;
      if (settled) break;
    } else if (!now) {
      return std::nullopt;
    } else {
      damping *= 10;
    }
    Matrix3d damped = now->H;
    damped.diagonal() *= 1 + damping;
    damped(2, 2) += 1e-9;
    out.at = best + damped.ldlt().solve(now->g);
    out.at.z() = std::max(out.at.z(), p.triangulation.min_inverse_depth);
  }
  out.at = best;
  out.rms_px = std::sqrt(now->sum / static_cast<double>(track.size()));
  return out;
}

}  // namespace odograph::vio
