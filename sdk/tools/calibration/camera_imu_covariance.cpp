// SPDX-License-Identifier: Apache-2.0
//
// What the shared unknowns are worth: the sandwich of information and scatter, windows and points taken out.
#include <cmath>

#include <Eigen/Dense>

#include "sdk/tools/calibration/camera_imu_window.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector2d, Eigen::VectorXd;

constexpr double kSteady_s = 1;  // windows' scores are taken together over this time

}  // namespace

MatrixXd CameraImuProblem::covariance() const {
  std::vector<Eigen::Index> place;  // of each free column among all
  for (Eigen::Index i = 0; i < shared::count; ++i)
    if (!fixed_[static_cast<size_t>(i)]) place.push_back(i);
  const auto n = static_cast<Eigen::Index>(place.size());
  // Of each window: rows of J for the free shared unknowns and the path, what the points explain projected out corner
  // by corner, then what the path explains.
  MatrixXd information = MatrixXd::Zero(n, n), scatter = MatrixXd::Zero(n, n);
  VectorXd score = VectorXd::Zero(n);
  double since_s = -INFINITY;
  int spans = 0;
  const auto close = [&] {
    if (score.squaredNorm() > 0) ++spans;
    scatter += score * score.transpose();
    score.setZero();
  };
  constexpr Eigen::Index kRows = 2 * kWindowFrames;
  size_t block = 0;
  for (const auto& window : windows_) {
    MatrixXd rows(kRows * static_cast<Eigen::Index>(window->corners.size()), n + kPath);
    VectorXd values(rows.rows());
    for (size_t i = 0; i < window->corners.size(); ++i) {
      MatrixXd J(kRows, n + kPath);
      Eigen::Matrix<double, kRows, 3> own;
      for (size_t k = 0; k < kWindowFrames; ++k, ++block) {
        Eigen::Matrix<double, 2, shared::count, Eigen::RowMajor> by_shared;
        Eigen::Matrix<double, 2, kPath, Eigen::RowMajor> by_path;
        Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
        double* jacobians[] = {by_shared.data(), by_path.data(), by_point.data()};
        const double* blocks[] = {x_.data(), window->path.data(), window->points + 3 * i};
        Vector2d r;
        problem_->GetCostFunctionForResidualBlock(blocks_[block])->Evaluate(blocks, r.data(), jacobians);
        const double weight = 1 / std::sqrt(1 + r.squaredNorm() / (scale_px_ * scale_px_));  // Cauchy's
        const auto row = 2 * static_cast<Eigen::Index>(k);
        for (Eigen::Index c = 0; c < n; ++c)
          J.block<2, 1>(row, c) = weight * by_shared.col(place[static_cast<size_t>(c)]);
        J.block<2, kPath>(row, n) = weight * by_path;
        own.block<2, 3>(row, 0) = weight * by_point;
        values.segment<2>(kRows * static_cast<Eigen::Index>(i) + row) = weight * r;
      }
      const Matrix3d weight = own.transpose() * own + 1e-9 * Matrix3d::Identity();
      rows.middleRows<kRows>(kRows * static_cast<Eigen::Index>(i)) = J - own * weight.ldlt().solve(own.transpose() * J);
    }
    const MatrixXd path = rows.rightCols<kPath>();
    MatrixXd weight = path.transpose() * path;
    weight.diagonal().array() += std::pow(kBend, -2);
    weight.diagonal().tail<3>().array() += 1e3;
    const MatrixXd left = rows.leftCols(n) - path * weight.ldlt().solve(path.transpose() * rows.leftCols(n));
    information += left.transpose() * left;
    if (window->t_s[0] - since_s > kSteady_s) close(), since_s = window->t_s[0];
    score += left.transpose() * values;
  }
  close();
  scatter *= spans > 1 ? spans / (spans - 1.0) : 1.0;
  for (Eigen::Index i = 0; i < n; ++i)
    if (const double sigma = at_.prior_sigma[place[static_cast<size_t>(i)]]; sigma > 0)
      information(i, i) += std::pow(sigma, -2), scatter(i, i) += std::pow(sigma, -2);
  // Scaled to a unit diagonal first: the unknowns have different units.
  const VectorXd unit = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(unit.asDiagonal() * information * unit.asDiagonal());
  const VectorXd inverted = eigen.eigenvalues().cwiseMax(1e-12).cwiseInverse();
  const MatrixXd inverse = unit.asDiagonal() *
                           (eigen.eigenvectors() * inverted.asDiagonal() * eigen.eigenvectors().transpose()) *
                           unit.asDiagonal();
  const MatrixXd free = inverse * scatter * inverse;
  MatrixXd out = MatrixXd::Zero(shared::count, shared::count);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k) out(place[static_cast<size_t>(i)], place[static_cast<size_t>(k)]) = free(i, k);
  return out;
}

}  // namespace odograph
