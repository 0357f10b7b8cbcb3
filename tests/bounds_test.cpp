// SPDX-License-Identifier: Apache-2.0
//
// What is a covariance, against eigenvalues.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>

#include <Eigen/Eigenvalues>

#include "sdk/host/messages/bounds.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("bounds");

TEST_CASE("matrices that are a covariance, up to rounding, and that are none") {
  std::srand(3);
  for (int i = 0; i < 1000; ++i)
    for (const int n : {3, 6}) {
      const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, 1 + i % n);  // of every rank
      const Eigen::VectorXd units = Eigen::VectorXd::Random(n).unaryExpr([](double x) { return std::pow(10, 4 * x); });
      Eigen::MatrixXd C = units.asDiagonal() * (A * A.transpose()) * units.asDiagonal();
      CHECK(bounds::is_covariance(C.data(), static_cast<size_t>(n)));
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A * A.transpose());
      const Eigen::VectorXd v = solver.eigenvectors().col(0);
      const Eigen::MatrixXd worse = A * A.transpose() - (solver.eigenvalues()[0] + 0.2) * v * v.transpose();
      C = units.asDiagonal() * worse * units.asDiagonal();
      CHECK_FALSE(bounds::is_covariance(C.data(), static_cast<size_t>(n)));
    }
}

TEST_SUITE_END();
