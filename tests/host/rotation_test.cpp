// SPDX-License-Identifier: Apache-2.0
//
// Rotations against Eigen's angle-axis, the matrix exponential and logarithm, and numeric derivatives; rays of pixels.
#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

#include "sdk/math/lens.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("rotation");

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Rotation vectors of all sizes below half a turn.
std::vector<Vector3d> rotation_vectors() {
  odograph::Random random(7, 1);
  std::vector<Vector3d> all{Vector3d::Zero()};
  for (const double angle : {1e-300, 1e-18, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 0.9e-4, 1.1e-4, 1e-3, 0.1, 1.0, 2.0, 3.1})
    for (int k = 0; k < 8; ++k)
      all.push_back(angle * Vector3d{random.normal(), random.normal(), random.normal()}.normalized());
  return all;
}

double difference(const Matrix3d& a, const Matrix3d& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("Exp is the matrix exponential of the cross product matrix, and a unit quaternion") {
  for (const Vector3d& v : rotation_vectors()) {
    CAPTURE(v.norm());
    const Matrix3d expected = odograph::skew(v).exp();
    const Quaterniond q = odograph::exp_rotation(v);
    CHECK(difference(q.toRotationMatrix(), expected) < 1e-14);
    CHECK(std::abs(q.norm() - 1) < 1e-15);
    CHECK(difference(odograph::exp_rotation_matrix(v), expected) < 1e-14);
    if (v.norm() > 0) {
      const Matrix3d by_angle = Eigen::AngleAxisd(v.norm(), v.normalized()).toRotationMatrix();
      CHECK(difference(q.toRotationMatrix(), by_angle) < 1e-14);
    }
  }
}

TEST_CASE("Log inverts Exp for q and -q, with an error relative to the angle") {
  for (const Vector3d& v : rotation_vectors()) {
    CAPTURE(v.norm());
    const Quaterniond q = odograph::exp_rotation(v), minus(-q.coeffs());
    const double bound = 1e-13 * v.norm() + 1e-300;
    for (const Quaterniond& same : {q, minus}) CHECK((odograph::log_rotation(same) - v).norm() <= bound);
    if (v.norm() > 1e-6)
      CHECK(difference(odograph::skew(odograph::log_rotation(q)), q.toRotationMatrix().log()) < 1e-8);
  }
}

TEST_CASE("the shortest rotation is Eigen's between any two directions, and half a turn across opposite ones") {
  odograph::Random random(11, 1);
  const auto draw = [&] { return Vector3d{random.normal(), random.normal(), random.normal()}; };
  for (int k = 0; k < 200; ++k) {
    const Vector3d from = draw();
    const Vector3d to = k % 4 == 0 ? Vector3d(-from + 1e-3 * draw()) : k % 4 == 1 ? Vector3d(2 * from) : draw();
    CHECK(odograph::shortest_rotation(from, to).coeffs() == Quaterniond::FromTwoVectors(from, to).coeffs());
  }
  for (int k = 0; k < 20; ++k) {
    const Vector3d from = k < 6 ? Vector3d((k < 3 ? 1 : -1) * Vector3d::Unit(k % 3)) : draw();
    const Quaterniond q = odograph::shortest_rotation(from, -2 * from);
    CHECK(std::abs(q.norm() - 1) < 1e-15);
    CHECK((q * from + from).norm() < 1e-7 * from.norm());
    CHECK(std::abs(q.vec().dot(from)) < 1e-15 * from.norm());  // not a turn about the direction itself
  }
}

TEST_CASE("the left Jacobian is Exp's numeric derivative on the left, and series and closed form agree") {
  for (const Vector3d& v : rotation_vectors()) {
    CAPTURE(v.norm());
    const Matrix3d J = odograph::left_jacobian(v);
    constexpr double h = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d d = h * Vector3d::Unit(axis);
      const Quaterniond plus = odograph::exp_rotation(v + d), minus = odograph::exp_rotation(v - d);
      const Vector3d numeric = odograph::log_rotation(plus * minus.conjugate()) / (2 * h);
      CHECK((J.col(axis) - numeric).norm() < 1e-8);
    }
    // Sola 2017, eq. (183).
    CHECK(difference(Matrix3d::Identity() + J * odograph::skew(v), odograph::exp_rotation(v).toRotationMatrix()) <
          1e-8);
  }
}

TEST_CASE("the cross product matrix, quaternions of messages and rigid transforms are correct") {
  const Vector3d a(0.3, -1.2, 2.5), b(-0.7, 0.4, 1.1);
  CHECK((odograph::skew(a) * b - a.cross(b)).norm() < 1e-15);
  const Quaterniond q = odograph::exp_rotation(a);
  double wxyz[4];
  odograph::put_quaternion(q, wxyz);
  CHECK(wxyz[0] == q.w());
  CHECK(wxyz[3] == q.z());
  CHECK(odograph::raw_quaternion(wxyz).coeffs() == q.coeffs());
  const double twice[4] = {2 * wxyz[0], 2 * wxyz[1], 2 * wxyz[2], 2 * wxyz[3]};
  CHECK((odograph::quaternion(twice).coeffs() - q.coeffs()).norm() < 1e-15);
  CHECK((odograph::isometry(q, b) * a - (q * a + b)).norm() < 1e-15);
}

TEST_CASE("a rear camera looks away from the viewer, its picture upright on an upright phone") {
  const Quaterniond q_b_c = odograph::rear_camera_mount();
  CHECK(q_b_c * Vector3d::UnitX() == Vector3d::UnitX());
  CHECK(q_b_c * Vector3d::UnitY() == -Vector3d::UnitY());
  CHECK(q_b_c * Vector3d::UnitZ() == -Vector3d::UnitZ());
}

TEST_CASE("the ray of a pixel is the inverse of both lens models, and none where the lens shows nothing") {
  const double radial[] = {-0.3, 0.1, 0.001, -0.002, -0.02}, fisheye[] = {0.02, -0.01, 0.003, -0.001};
  for (const auto& p : {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.3, -0.2), Eigen::Vector2d(-0.7, 0.5)}) {
    const auto ray = odograph::ray_of(odograph::radial_tangential(p, {radial, 5}), false, {radial, 5});
    REQUIRE(ray);
    CHECK((ray->head<2>() / ray->z() - p).norm() < 1e-8);
  }
  for (const double theta : {0.0, 0.4, 1.2, 1.8}) {  // the last one looks backwards
    const Eigen::Vector2d seen = odograph::kannala_brandt(theta, {fisheye, 4}) * Eigen::Vector2d(0.6, 0.8);
    const auto ray = odograph::ray_of(seen, true, {fisheye, 4});
    REQUIRE(ray);
    CHECK((*ray - Vector3d(0.6 * std::sin(theta), 0.8 * std::sin(theta), std::cos(theta))).norm() < 1e-7);
  }
  const double turning[] = {-0.5};  // r (1 - r^2 / 2) is never above 0.55
  CHECK_FALSE(odograph::ray_of({0.6, 0}, false, {turning, 1}));
}
