// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/upright_pose.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "sdk/math/rotation.hpp"

namespace odograph::place_map {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Two unit vectors across a unit vector.
Eigen::Matrix<double, 3, 2> across(const Vector3d& ray) {
  const Vector3d other = std::abs(ray.x()) < 0.7 ? Vector3d::UnitX() : Vector3d::UnitY();
  Eigen::Matrix<double, 3, 2> B;
  B.col(0) = ray.cross(other).normalized();
  B.col(1) = ray.cross(B.col(0));
  return B;
}

/// Error of a ray in its tangent plane, and its covariance.
struct RayError {
  Vector2d error;
  Eigen::Matrix2d covariance;
  double distance_m;
};
RayError ray_error(const Correspondence& match, const Rigid& T, const Eigen::Matrix<double, 3, 2>& B, double lens_rad,
                   double further_sigma_rad) {
  const Vector3d x = T * match.p_k;
  const double distance = std::max(1e-3, x.norm());
  const Vector2d along = B.transpose() * (T.q * match.p_k.normalized());
  const double square = 1 / (distance * distance), a2 = match.across_sigma * match.across_sigma;
  const double l2 = std::max(0.0, match.along_sigma * match.along_sigma - a2);
  const double common = match.sigma_rad * match.sigma_rad + lens_rad * lens_rad + further_sigma_rad * further_sigma_rad;
  RayError out;
  out.error = B.transpose() * (x / distance);
  if (x.dot(match.ray_c) <= 0) out.error.setConstant(10);  // behind
  out.covariance = (common + a2 * square) * Eigen::Matrix2d::Identity() + l2 * square * along * along.transpose();
  out.distance_m = distance;
  return out;
}

bool has_zoom(const Correspondence& match, const Rigid& T, double tolerance) {
  if (match.zoom <= 0) return true;
  const double ratio = match.p_k.norm() / std::max(1e-3, (T * match.p_k).norm()) / match.zoom;
  return ratio < tolerance && ratio > 1 / tolerance;
}

/// Quality of a pose: inliers, each by its confidence and less by its distance.
double score(const std::vector<Correspondence>& matches, const Rigid& T, const PoseParameters& p, double tilt_rad,
             std::vector<size_t>* inliers = nullptr) {
  double sum = 0;
  if (inliers) inliers->clear();
  for (size_t i = 0; i < matches.size(); ++i) {
    const Vector3d x = T * matches[i].p_k;
    if (x.dot(matches[i].ray_c) < 0.9 * x.norm() || !has_zoom(matches[i], T, p.max_zoom_error)) continue;
    const double squared = residual_of(matches[i], T, p.lens_rad, tilt_rad).squared;
    if (squared >= p.gate) continue;
    sum += matches[i].confidence * (1 - squared / p.gate);
    if (inliers) inliers->push_back(i);
  }
  return sum;
}

/// A seeded generator whose numbers are the same on every platform.
class Draws {
 public:
  size_t below(size_t count) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<size_t>((state_ >> 33) % count);
  }

 private:
  uint64_t state_ = 1;
};

}  // namespace

Residual residual_of(const Correspondence& match, const Rigid& T, double lens_rad, double further_sigma_rad) {
  const RayError e = ray_error(match, T, across(match.ray_c), lens_rad, further_sigma_rad);
  const double determinant = e.covariance.determinant();
  const Vector2d& r = e.error;
  const double squared = (e.covariance(1, 1) * r.x() * r.x() - 2 * e.covariance(0, 1) * r.x() * r.y() +
                          e.covariance(0, 0) * r.y() * r.y()) /
                         determinant;
  return {squared, M_PI * std::sqrt(determinant)};
}

std::vector<Rigid> two_point_poses(const Vector3d& X0, const Vector3d& X1, const Vector3d& ray0, const Vector3d& ray1) {
  // R(yaw) (X1 - X0) = b ray1 - a ray0. The vertical part is a line in the plane of (a, b), the length of the
  // horizontal part a conic: their intersections.
  const Vector3d D = X1 - X0;
  const Vector2d normal(-ray0.z(), ray1.z());
  const double n2 = normal.squaredNorm();
  std::vector<Rigid> poses;
  if (n2 < 1e-8) return poses;  // both horizontal: any distance fits
  const Vector2d foot = D.z() / n2 * normal, direction(normal.y(), -normal.x());
  const Vector2d u = foot.y() * ray1.head<2>() - foot.x() * ray0.head<2>();
  const Vector2d v = direction.y() * ray1.head<2>() - direction.x() * ray0.head<2>();
  const double A = v.squaredNorm(), B = u.dot(v), C = u.squaredNorm() - D.head<2>().squaredNorm();
  const double discriminant = B * B - A * C;
  if (A < 1e-12 || discriminant < 0) return poses;
  for (const double sign : {-1.0, 1.0}) {
    const double s = (-B + sign * std::sqrt(discriminant)) / A;
    const Vector2d ab = foot + s * direction;
    if (!(ab.x() > 0 && ab.y() > 0)) continue;
    const Vector2d seen = u + s * v;
    const double yaw = std::atan2(D.x() * seen.y() - D.y() * seen.x(), D.head<2>().dot(seen));
    const Quaterniond q(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
    poses.push_back({q, ab.x() * ray0 - q * X0});
  }
  return poses;
}

std::optional<RefinedPose> refine_pose(const std::vector<Correspondence>& matches, const Gravity& gravity,
                                       const Rigid& start, const PoseParameters& p) {
  if (matches.size() < 3) return std::nullopt;
  Rigid T = start;
  Matrix6d H;
  for (int iteration = 0; iteration <= p.iterations; ++iteration) {
    H.setZero();
    Vector6d b = Vector6d::Zero();
    for (const Correspondence& match : matches) {
      const auto B = across(match.ray_c);
      const RayError e = ray_error(match, T, B, p.lens_rad, 0);
      const Vector3d x = T * match.p_k, direction = x / e.distance_m;
      const Eigen::Matrix<double, 2, 3> by_point =
          B.transpose() * (Matrix3d::Identity() - direction * direction.transpose()) / e.distance_m;
      Eigen::Matrix<double, 2, 6> J;
      J.leftCols<3>() = -by_point * skew(T.q * match.p_k);
      J.rightCols<3>() = by_point;
      Eigen::Matrix2d W = e.covariance.inverse();
      const double squared = e.error.dot(W * e.error);
      if (squared > 4) W *= 2 / std::sqrt(squared);  // Huber beyond two sigmas
      H += J.transpose() * W * J;
      b -= J.transpose() * W * e.error;
    }
    const auto B = across(gravity.down_c);
    const Vector3d down = T.q * gravity.down_k;
    Eigen::Matrix<double, 2, 6> J = Eigen::Matrix<double, 2, 6>::Zero();
    J.leftCols<3>() = -B.transpose() * skew(down);
    const double weight = 1 / (gravity.sigma_rad * gravity.sigma_rad);
    H += weight * J.transpose() * J;
    b -= weight * J.transpose() * (B.transpose() * down);
    if (iteration == p.iterations) break;
    const Eigen::LDLT<Matrix6d> solver(H);
    const Vector6d step = solver.solve(b);
    if (solver.info() != Eigen::Success || !step.allFinite() || step.head<3>().norm() > 1) return std::nullopt;
    T.q = (exp_rotation(step.head<3>()) * T.q).normalized();
    T.p += step.tail<3>();  // the rotation is about k's origin, which T.p is in c
  }
  return RefinedPose{T, H};
}

std::optional<RansacPose> ransac_pose(const std::vector<Correspondence>& matches, const Gravity& gravity,
                                      const PoseParameters& p) {
  if (matches.size() < 3) return std::nullopt;
  const Quaterniond q_u_k = shortest_rotation(gravity.down_k, Vector3d::UnitZ());
  const Quaterniond q_u_c = shortest_rotation(gravity.down_c, Vector3d::UnitZ());
  std::vector<Vector3d> X, rays;
  for (const Correspondence& match : matches) X.push_back(q_u_k * match.p_k), rays.push_back(q_u_c * match.ray_c);
  Draws draws;
  RansacPose best;
  double best_score = 0, best_start = 0;
  std::vector<size_t> inliers;
  int trials = p.trials;
  for (int trial = 0; trial < trials; ++trial) {
    // Progressive: pairs of the most distinctive matches first (Chum & Matas 2005).
    const size_t pool = std::min(matches.size(), static_cast<size_t>(8 + trial / 3));
    const size_t i = draws.below(pool), k = draws.below(pool);
    if (i == k || matches[i].landmark == matches[k].landmark || matches[i].feature == matches[k].feature) continue;
    for (const Rigid& upright : two_point_poses(X[i], X[k], rays[i], rays[k])) {
      Rigid T{(q_u_c.conjugate() * upright.q * q_u_k).normalized(), q_u_c.conjugate() * upright.p};
      if (!has_zoom(matches[i], T, p.max_zoom_error) || !has_zoom(matches[k], T, p.max_zoom_error)) continue;
      const double start = score(matches, T, p, gravity.sigma_rad, &inliers);
      if (start <= best_start) continue;
      best_start = start;
      for (int round = 0; round < 3; ++round) {
        std::vector<Correspondence> agreeing;
        for (const size_t at : inliers) agreeing.push_back(matches[at]);
        const auto refined = refine_pose(agreeing, gravity, T, p);
        if (!refined) break;
        T = refined->T_c_k;
        const double refined_score = score(matches, T, p, 0, &inliers);
        if (refined_score > best_score) best_score = refined_score, best = {T, inliers};
      }
      const double share = static_cast<double>(best.inliers.size()) / static_cast<double>(matches.size());
      const double needed = std::log(1e-4) / std::log(1 - std::min(0.99, share * share));  // -inf without inliers
      trials = std::min(p.trials, static_cast<int>(std::clamp(needed, 100.0, 1e6)));
    }
  }
  if (best.inliers.size() < 3) return std::nullopt;
  return best;
}

}  // namespace odograph::place_map
