// SPDX-License-Identifier: Apache-2.0
//
// The right perturbations listed in docs/notation.md: their derivatives against finite differences.
#include "plugins/vo/odograph/visual/bundle_costs.hpp"
#undef CHECK  // glog's, which Ceres includes
#include <Eigen/LU>

#include "plugins/vo/odograph/visual/pose_fit.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/support.hpp"

using namespace odograph::vo;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

TEST_SUITE_BEGIN("rotation");

namespace {

using Block = std::vector<double>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Vector3d vector(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

Block pose_block(const Quaterniond& q, const Vector3d& p) { return {q.x(), q.y(), q.z(), q.w(), p.x(), p.y(), p.z()}; }

/// By the manifold's documentation, not its code: rotated on the right, moved in w.
Block moved(Block x, const VectorXd& tangent) {
  if (x.size() != 7) {
    for (size_t i = 0; i < x.size(); ++i) x[i] += tangent[static_cast<Eigen::Index>(i)];
    return x;
  }
  const Quaterniond q = Quaterniond(x[3], x[0], x[1], x[2]) * exp_rotation(tangent.head<3>());
  return pose_block(q, Vector3d(x[4], x[5], x[6]) + tangent.segment<3>(3));
}

VectorXd residuals(const ceres::CostFunction& cost, const std::vector<Block>& x) {
  std::vector<const double*> at;
  for (const Block& block : x) at.push_back(block.data());
  VectorXd r(cost.num_residuals());
  REQUIRE(cost.Evaluate(at.data(), r.data(), nullptr));
  return r;
}

/// Largest difference of the derivatives by the tangents, over the largest derivative.
double worst_derivative(const ceres::CostFunction& cost, const std::vector<Block>& x) {
  std::vector<RowMajor> J;
  std::vector<const double*> at;
  for (const Block& block : x) {
    at.push_back(block.data());
    J.emplace_back(cost.num_residuals(), static_cast<Eigen::Index>(block.size()));
  }
  std::vector<double*> jacobians;
  for (RowMajor& j : J) jacobians.push_back(j.data());
  VectorXd r(cost.num_residuals());
  REQUIRE(cost.Evaluate(at.data(), r.data(), jacobians.data()));
  double off = 0, largest = 0;
  for (size_t k = 0; k < x.size(); ++k) {
    const Eigen::Index n = x[k].size() == 7 ? 6 : static_cast<Eigen::Index>(x[k].size());
    for (Eigen::Index i = 0; i < n; ++i) {
      constexpr double h = 1e-6;
      std::vector<Block> above = x, below = x;
      above[k] = moved(x[k], h * VectorXd::Unit(n, i)), below[k] = moved(x[k], -h * VectorXd::Unit(n, i));
      const VectorXd numeric = (residuals(cost, above) - residuals(cost, below)) / (2 * h);
      off = std::max(off, (J[k].col(i) - numeric).cwiseAbs().maxCoeff());
      largest = std::max(largest, numeric.cwiseAbs().maxCoeff());
    }
  }
  return off / largest;
}

}  // namespace

TEST_CASE("the window's manifold rotates on the right, and its difference is the inverse") {
  Random random(3, 1);
  const bundle::PoseManifold manifold;
  for (int k = 0; k < 20; ++k) {
    const Quaterniond rotation = exp_rotation(vector(random));
    const Block x = pose_block(rotation, vector(random));
    VectorXd tangent(6), back(6);
    tangent << 0.5 * vector(random), vector(random);
    Block y(7);
    REQUIRE(manifold.Plus(x.data(), tangent.data(), y.data()));
    const Block expected = moved(x, tangent);
    for (size_t i = 0; i < 7; ++i) CHECK(std::abs(y[i] - expected[i]) < 1e-14);
    REQUIRE(manifold.Minus(y.data(), x.data(), back.data()));
    CHECK((back - tangent).norm() < 1e-13);
  }
}

TEST_CASE("the derivatives of the window's terms equal finite differences on the right") {
  Random random(4, 1);
  for (int k = 0; k < 20; ++k) {
    CAPTURE(k);
    const Quaterniond q_a = exp_rotation(vector(random)), q_j = q_a * exp_rotation(0.1 * vector(random));
    const Block a = pose_block(q_a, vector(random)), j = pose_block(q_j, Vector3d(a[4], a[5], a[6]) + vector(random));
    const bundle::Reprojection seen({0.1, -0.2}, {0.15, -0.1}, 1e-3, 0.01);
    CHECK(worst_derivative(seen, {a, j, {0.1}}) < 1e-7);
    CHECK(worst_derivative(bundle::Length(1.3, 0.01), {a, j}) < 1e-7);
    const Vector3d bias = 0.01 * vector(random);
    const Eigen::Matrix3d by_bias = -0.4 * exp_rotation(0.2 * vector(random)).toRotationMatrix();
    // First order in the error, hence a small one: Log's Jacobian at 1e-4 rad is off by half of it.
    const Quaterniond measured = q_a.conjugate() * q_j * exp_rotation(1e-4 * vector(random).normalized());
    const bundle::Rotation rotation({measured, by_bias, 2e-4}, bias);
    CHECK(worst_derivative(rotation, {a, j, {bias.x(), bias.y(), bias.z()}}) < 1e-4);
    CHECK(worst_derivative(bundle::BiasPrior(bias, 0.01), {{0.1, 0.2, 0.3}}) < 1e-7);
  }
}

TEST_CASE("a fitted pose's covariance is that of a right perturbation, by finite differences") {
  Random random(5, 1);
  constexpr double kSigma = 1e-3, h = 1e-6;
  const Quaterniond q = exp_rotation({0.4, -0.9, 0.3});  // large, so that left and right differ
  const Vector3d p(0.5, -1, 0.2);
  std::vector<PointSeen> points;
  MatrixXd information = MatrixXd::Zero(6, 6);
  for (int k = 0; k < 60; ++k) {
    const Vector3d y{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(3, 9)}, X = q * y + p;
    points.push_back({X.homogeneous(), y.head<2>() / y.z(), p, 0});
    const auto projected = [&](const VectorXd& tangent) -> Eigen::Vector2d {
      const Block x = moved(pose_block(q, p), tangent);
      return (Quaterniond(x[3], x[0], x[1], x[2]).conjugate() * (X - Vector3d(x[4], x[5], x[6]))).hnormalized();
    };
    MatrixXd J(2, 6);
    for (Eigen::Index i = 0; i < 6; ++i)
      J.col(i) = (projected(h * VectorXd::Unit(6, i)) - projected(-h * VectorXd::Unit(6, i))) / (2 * h);
    information += J.transpose() * J / (kSigma * kSigma);
  }
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = q.toRotationMatrix(), T.translation() = p;
  const auto fit = required(fit_pose(points, T, kSigma, kSigma, std::nullopt));
  CHECK((MatrixXd(fit->covariance) * information - MatrixXd::Identity(6, 6)).norm() < 1e-5);
}
