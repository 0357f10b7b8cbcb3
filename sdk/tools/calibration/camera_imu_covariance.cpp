// SPDX-License-Identifier: Apache-2.0
//
// Covariance of the shared unknowns: sandwich estimate from information and score scatter, windows and points
// marginalised.
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "sdk/tools/calibration/camera_imu_window.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector2d, Eigen::VectorXd;

constexpr double kSteady_s = 1;  // scores of windows are summed over this time

constexpr Eigen::Index kRows = 2 * kWindowFrames;  // per corner

/// Sums the scores over each second, and their scatter.
class Scatter {
 public:
  explicit Scatter(Eigen::Index n) : sum_(MatrixXd::Zero(n, n)), score_(VectorXd::Zero(n)) {}
  void add(double t_s, const VectorXd& score) {
    if (t_s - since_s_ > kSteady_s) close(), since_s_ = t_s;
    score_ += score;
  }
  MatrixXd finish() {
    close();
    return sum_ * (spans_ > 1 ? spans_ / (spans_ - 1.0) : 1.0);
  }

 private:
  void close() {
    if (score_.squaredNorm() > 0) ++spans_;
    sum_ += score_ * score_.transpose();
    score_.setZero();
  }
  MatrixXd sum_;
  VectorXd score_;
  double since_s_ = -INFINITY;
  int spans_ = 0;
};

/// Pseudo-inverse after scaling to a unit diagonal, because the unknowns have different units.
MatrixXd inverse_of(const MatrixXd& information) {
  const VectorXd unit = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scaled);
  const VectorXd inverted = eigen.eigenvalues().cwiseMax(1e-12).cwiseInverse();
  const MatrixXd left = eigen.eigenvectors() * inverted.asDiagonal();
  const MatrixXd inverse = left * eigen.eigenvectors().transpose();
  return unit.asDiagonal() * inverse * unit.asDiagonal();
}

}  // namespace

/// Weighted Jacobian rows and residuals of a window for the free shared unknowns (`free`: their columns) and its path,
/// projected onto the complement of each corner's point. `block`: index of its first residual block.
void CameraImuProblem::rows_of(const Window& window, const std::vector<Eigen::Index>& free, size_t& block,
                               MatrixXd& rows, VectorXd& values) const {
  const auto n = static_cast<Eigen::Index>(free.size());
  rows.resize(kRows * static_cast<Eigen::Index>(window.corners.size()), n + kPath);
  values.resize(rows.rows());
  for (size_t i = 0; i < window.corners.size(); ++i) {
    MatrixXd J(kRows, n + kPath);
    Eigen::Matrix<double, kRows, 3> own;
    for (size_t k = 0; k < kWindowFrames; ++k, ++block) {
      Eigen::Matrix<double, 2, shared::count, Eigen::RowMajor> by_shared;
      Eigen::Matrix<double, 2, kPath, Eigen::RowMajor> by_path;
      Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
      double* jacobians[] = {by_shared.data(), by_path.data(), by_point.data()};
      const double* blocks[] = {x_.data(), window.path.data(), window.points + 3 * i};
      Vector2d r;
      problem_->GetCostFunctionForResidualBlock(blocks_[block])->Evaluate(blocks, r.data(), jacobians);
      const double weight = 1 / std::sqrt(1 + r.squaredNorm() / (scale_px_ * scale_px_));  // Cauchy's
      const auto row = 2 * static_cast<Eigen::Index>(k);
      for (Eigen::Index c = 0; c < n; ++c) J.block<2, 1>(row, c) = weight * by_shared.col(free[static_cast<size_t>(c)]);
      J.block<2, kPath>(row, n) = weight * by_path;
      own.block<2, 3>(row, 0) = weight * by_point;
      values.segment<2>(kRows * static_cast<Eigen::Index>(i) + row) = weight * r;
    }
    const Matrix3d weight = own.transpose() * own + 1e-9 * Matrix3d::Identity();
    rows.middleRows<kRows>(kRows * static_cast<Eigen::Index>(i)) = J - own * weight.ldlt().solve(own.transpose() * J);
  }
}

MatrixXd CameraImuProblem::covariance() const {
  std::vector<Eigen::Index> free;  // columns among all
  for (Eigen::Index i = 0; i < shared::count; ++i)
    if (!fixed_[static_cast<size_t>(i)]) free.push_back(i);
  const auto n = static_cast<Eigen::Index>(free.size());
  MatrixXd information = MatrixXd::Zero(n, n);
  Scatter scores(n);
  size_t block = 0;
  MatrixXd rows;
  VectorXd values;
  for (const auto& window : windows_) {
    rows_of(*window, free, block, rows, values);
    // Projects the path out.
    const MatrixXd path = rows.rightCols<kPath>();
    MatrixXd weight = path.transpose() * path;
    weight.diagonal().array() += std::pow(kBend, -2);
    weight.diagonal().tail<3>().array() += 1e3;
    const MatrixXd shared = rows.leftCols(n), across = path.transpose() * shared;
    const MatrixXd solved = weight.ldlt().solve(across), left = shared - path * solved;
    information += left.transpose() * left;
    scores.add(window->t_s[0], left.transpose() * values);
  }
  MatrixXd scatter = scores.finish();
  for (Eigen::Index i = 0; i < n; ++i)
    if (const double sigma = at_.prior_sigma[free[static_cast<size_t>(i)]]; sigma > 0)
      information(i, i) += std::pow(sigma, -2), scatter(i, i) += std::pow(sigma, -2);
  const MatrixXd inverse = inverse_of(information);
  const MatrixXd half = inverse * scatter, of_free = half * inverse;
  MatrixXd out = MatrixXd::Zero(shared::count, shared::count);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k)
      out(free[static_cast<size_t>(i)], free[static_cast<size_t>(k)]) = of_free(i, k);
  return out;
}

}  // namespace odograph
