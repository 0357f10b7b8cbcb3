// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/pose_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "sdk/math/rotation.hpp"

namespace odograph::vo {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kNearest = 1e-9;  // min depth of a point, homogeneous: avoids division by zero

/// Information of an observation: corner noise, and the depth variance along the epipolar line.
Eigen::Matrix2d certainty(const Eigen::Vector2d& by_inverse_depth, double variance, double sigma) {
  const double share = variance / (sigma * sigma);
  return Eigen::Matrix2d::Identity() -
         by_inverse_depth * by_inverse_depth.transpose() * (share / (1 + share * by_inverse_depth.squaredNorm()));
}

/// A point projected with a pose.
struct Projected {
  Eigen::Vector3d y;                 ///< in c, homogeneous
  Eigen::Vector2d error;             ///< reprojection error
  Eigen::Matrix<double, 2, 3> by_y;  ///< of the projection
  Eigen::Matrix2d certain;           ///< information(), see certainty()
};
/// Nothing if it is behind the camera.
std::optional<Projected> project(const PointSeen& point, const Eigen::Matrix3d& R_c_w, const Eigen::Vector3d& p_w,
                                 double sigma) {
  Projected out;
  const Eigen::Vector3d y = out.y = R_c_w * (point.X_w.head<3>() - point.X_w.w() * p_w);
  if (y.z() <= kNearest) return std::nullopt;
  out.error = y.head<2>() / y.z() - point.seen;
  out.by_y << 1 / y.z(), 0, -y.x() / (y.z() * y.z()), 0, 1 / y.z(), -y.y() / (y.z() * y.z());
  out.certain = certainty(out.by_y * (R_c_w * (point.anchor_w - p_w)), point.inverse_depth_variance, sigma);
  return out;
}

/// Gauss-Newton equations: right perturbation of the rotation, position in w.
struct Normal {
  Matrix6d H = Matrix6d::Identity() * 1e-9;
  Vector6d g = Vector6d::Zero();
};
Normal normal_equations(const std::vector<PointSeen>& points, const Eigen::Isometry3d& T_w_c, double sigma,
                        double scale, const std::optional<RotationPrior>& prior) {
  Normal n;
  const Eigen::Matrix3d R_c_w = T_w_c.linear().transpose();
  const Eigen::Vector3d p = T_w_c.translation();
  for (const PointSeen& point : points) {
    const auto seen = project(point, R_c_w, p, sigma);
    if (!seen) continue;
    const double weight = scale * scale / (scale * scale + seen->error.dot(seen->certain * seen->error));
    Eigen::Matrix<double, 2, 6> J;
    J.leftCols<3>() = seen->by_y * skew(seen->y);
    J.rightCols<3>() = -point.X_w.w() * seen->by_y * R_c_w;
    const double w = weight * weight / (sigma * sigma);
    n.H += w * J.transpose() * seen->certain * J;
    n.g += w * J.transpose() * (seen->certain * seen->error);
  }
  if (prior) {
    const double w = 1 / (prior->sigma_rad * prior->sigma_rad);
    const Eigen::Quaterniond q(T_w_c.linear());
    n.H.topLeftCorner<3, 3>() += w * Eigen::Matrix3d::Identity();
    n.g.head<3>() += w * log_rotation(prior->q_w_c.conjugate() * q);
  }
  return n;
}

/// Counts the inliers of a pose and their errors.
void count_inliers(const std::vector<PointSeen>& points, double sigma, double inlier_sigmas, FittedPose& fit) {
  fit.inliers.assign(points.size(), 0);
  double sum = 0;
  const Eigen::Matrix3d R_c_w = fit.T_w_c.linear().transpose();
  for (size_t i = 0; i < points.size(); ++i) {
    const auto seen = project(points[i], R_c_w, fit.T_w_c.translation(), sigma);
    if (!seen) continue;
    const double error = std::sqrt(seen->error.dot(seen->certain * seen->error));
    if (error > inlier_sigmas * sigma) continue;
    fit.inliers[i] = 1;
    ++fit.count;
    sum += error * error;
  }
  fit.rms = fit.count > 0 ? std::sqrt(sum / fit.count) : 0;
}

}  // namespace

std::optional<FittedPose> fit_pose(const std::vector<PointSeen>& points, const Eigen::Isometry3d& start, double sigma,
                                   double loose, const std::optional<RotationPrior>& prior,
                                   const PoseFitParameters& p) {
  FittedPose fit;
  fit.T_w_c = start;
  Matrix6d H;
  for (int iteration = 0; iteration < p.iterations; ++iteration) {
    const double scale = std::max(p.min_scale * sigma, loose * std::pow(p.shrink, iteration));
    const Normal normal = normal_equations(points, fit.T_w_c, sigma, scale, prior);
    H = normal.H;
    const Eigen::LDLT<Matrix6d> solver(H);
    if (solver.info() != Eigen::Success) return std::nullopt;
    const Vector6d step = -solver.solve(normal.g);
    if (!step.allFinite()) return std::nullopt;
    fit.T_w_c.linear() =
        (Eigen::Quaterniond(fit.T_w_c.linear()) * exp_rotation(step.head<3>())).normalized().toRotationMatrix();
    fit.T_w_c.translation() += step.tail<3>();
    if (iteration + 1 >= p.min_iterations && step.head<3>().norm() < p.settled_rad) break;
  }
  fit.covariance = H.inverse();
  count_inliers(points, sigma, p.inlier_sigmas, fit);
  return fit;
}

}  // namespace odograph::vo
