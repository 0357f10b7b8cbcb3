// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/visual/pose_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "plugins/vo/odograph/visual/gyroscope.hpp"

namespace odograph::vo {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr int kIterations = 12;
constexpr double kInlier = 3.0;  // sigmas

/// Inverse of the covariance of an observation, by that of a corner alone: along the epipolar line the depth's share.
Eigen::Matrix2d certainty(const Eigen::Vector2d& by_inverse_depth, double variance, double sigma) {
  const double share = variance / (sigma * sigma);
  return Eigen::Matrix2d::Identity() -
         by_inverse_depth * by_inverse_depth.transpose() * (share / (1 + share * by_inverse_depth.squaredNorm()));
}

}  // namespace

std::optional<FittedPose> fit_pose(const std::vector<PointSeen>& points, const Eigen::Isometry3d& start, double sigma,
                                   double loose, const std::optional<RotationPrior>& prior) {
  FittedPose fit;
  fit.T_w_c = start;
  Matrix6d H;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const double scale = std::max(2.5 * sigma, loose * std::pow(0.4, iteration));
    H = Matrix6d::Identity() * 1e-9;
    Vector6d g = Vector6d::Zero();
    const Eigen::Matrix3d R_c_w = fit.T_w_c.linear().transpose();
    const Eigen::Vector3d p = fit.T_w_c.translation();
    for (const PointSeen& point : points) {
      const Eigen::Vector3d y = R_c_w * (point.X_w.head<3>() - point.X_w.w() * p);
      if (y.z() <= 1e-9) continue;
      const Eigen::Vector2d error = y.head<2>() / y.z() - point.seen;
      Eigen::Matrix<double, 2, 3> P;
      P << 1 / y.z(), 0, -y.x() / (y.z() * y.z()), 0, 1 / y.z(), -y.y() / (y.z() * y.z());
      const Eigen::Matrix2d certain =
          certainty(P * (R_c_w * (point.anchor_w - p)), point.inverse_depth_variance, sigma);
      const double weight = scale * scale / (scale * scale + error.dot(certain * error));
      Eigen::Matrix<double, 2, 6> J;
      J.leftCols<3>() = P * cross_matrix(y);
      J.rightCols<3>() = -point.X_w.w() * P * R_c_w;
      const double w = weight * weight / (sigma * sigma);
      H += w * J.transpose() * certain * J;
      g += w * J.transpose() * (certain * error);
    }
    if (prior) {
      const double w = 1 / (prior->sigma_rad * prior->sigma_rad);
      const Eigen::Quaterniond q(fit.T_w_c.linear());
      H.topLeftCorner<3, 3>() += w * Eigen::Matrix3d::Identity();
      g.head<3>() += w * log_rotation(prior->q_w_c.conjugate() * q);
    }
    const Eigen::LDLT<Matrix6d> solver(H);
    if (solver.info() != Eigen::Success) return std::nullopt;
    const Vector6d step = -solver.solve(g);
    if (!step.allFinite()) return std::nullopt;
    fit.T_w_c.linear() =
        (Eigen::Quaterniond(fit.T_w_c.linear()) * exp_rotation(step.head<3>())).normalized().toRotationMatrix();
    fit.T_w_c.translation() += step.tail<3>();
    if (iteration > 4 && step.head<3>().norm() < 1e-7) break;
  }
  fit.covariance = H.inverse();
  fit.inliers.assign(points.size(), 0);
  double sum = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix3d R_c_w = fit.T_w_c.linear().transpose();
    const Eigen::Vector3d y = R_c_w * (points[i].X_w.head<3>() - points[i].X_w.w() * fit.T_w_c.translation());
    if (y.z() <= 1e-9) continue;
    Eigen::Matrix<double, 2, 3> P;
    P << 1 / y.z(), 0, -y.x() / (y.z() * y.z()), 0, 1 / y.z(), -y.y() / (y.z() * y.z());
    const Eigen::Vector2d off = y.head<2>() / y.z() - points[i].seen;
    const Eigen::Vector2d g = P * (R_c_w * (points[i].anchor_w - fit.T_w_c.translation()));
    const double error = std::sqrt(off.dot(certainty(g, points[i].inverse_depth_variance, sigma) * off));
    if (error > kInlier * sigma) continue;
    fit.inliers[i] = 1;
    ++fit.count;
    sum += error * error;
  }
  fit.rms = fit.count > 0 ? std::sqrt(sum / fit.count) : 0;
  return fit;
}

}  // namespace odograph::vo
