// SPDX-License-Identifier: Apache-2.0
//
// Validity of covariances, against eigenvalues.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <tuple>

#include <Eigen/Eigenvalues>

#include "sdk/host/messages/bounds.hpp"
#include "sdk/host/messages/messages.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("bounds");

TEST_CASE("valid covariances are accepted up to rounding, and invalid ones are rejected") {
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

TEST_CASE("a frame has at most 2^24 pixels in any shape") {
  const uint8_t pixel = 0;
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, 1);
  frame.format = ODO_FORMAT_GREY8, frame.planes[0].data = &pixel;
  for (const auto& [width, height, good] : {std::tuple{4096u, 4096u, true},
                                            {16384u, 1024u, true},
                                            {4032u, 3024u, true},
                                            {4097u, 4096u, false},
                                            {16384u, 1025u, false},
                                            {8000u, 6000u, false}}) {
    frame.width = width, frame.height = height;
    CHECK(message_is_good(frame.header) == good);
  }
}

TEST_SUITE_END();
