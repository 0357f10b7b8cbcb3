// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/gyro_attitude.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("gyro_attitude");

namespace {

const Eigen::Quaterniond kLevel = Eigen::Quaterniond::Identity();
const Eigen::Matrix3d kOneDegree = Eigen::Matrix3d::Identity() * 3e-4;

}  // namespace

TEST_CASE("at rest pictures give the gyroscope's bias and the accelerometer the vertical, and braking gives neither") {
  GyroAttitude filter;
  const Eigen::Quaterniond leaning(Eigen::AngleAxisd(0.02, Vector3d::UnitX()));
  filter.reset(leaning, kOneDegree);
  const Vector3d bias(0.006, -0.004, 0.003);
  const auto drive = [&](const Vector3d& accel_n, bool standing) {
    for (int frame = 0; frame < 50; ++frame) {  // of a horizontal camera, for five seconds
      const Eigen::Quaterniond turned = exp_rotation(0.1 * bias);
      filter.propagate(turned, 0.1);
      if (standing) filter.update_relative_rotation(turned, kLevel, 0, 0.1);
      filter.update_gravity(accel_n - Vector3d(0, 0, 9.81), standing);
    }
  };
  drive(Vector3d::Zero(), true);
  CHECK((filter.bias_c() - bias).norm() < 0.0005);
  const Vector3d up = filter.q_n_c() * -Vector3d::UnitZ();
  CHECK(std::hypot(up.x(), up.y()) < 0.004);
  drive({1.8, 0, 0}, false);
  const Vector3d after = filter.q_n_c() * -Vector3d::UnitZ();
  CHECK(std::hypot(after.x(), after.y()) < 0.012);
  const double sigma = std::sqrt(filter.covariance_n()(0, 0));
  CHECK(sigma == Between{0.001, 0.02});
}

TEST_CASE("orientation fixes correct a gyroscope attitude filter and its bias, and an outlier is rejected") {
  GyroAttitude filter;
  filter.reset(kLevel, kOneDegree);
  const Vector3d bias(0, 0, 0.008);
  for (int k = 0; k < 100; ++k) {
    filter.propagate(Eigen::Quaterniond(Eigen::AngleAxisd(bias.z() * 0.1, Vector3d::UnitZ())), 0.1);
    if (k % 5 != 4) continue;
    const Eigen::AngleAxisd off(filter.q_n_c().conjugate());
    CHECK(filter.correct(off.angle() * off.axis(), kOneDegree * 0.1, 5));
  }
  CHECK(std::abs(filter.bias_c().z() - 0.008) < 0.0012);
  CHECK(filter.q_n_c().angularDistance(kLevel) < 0.01);
  const Eigen::Quaterniond before = filter.q_n_c();
  CHECK_FALSE(filter.correct({0, 0, 0.5}, kOneDegree * 0.1, 5));
  CHECK(filter.q_n_c().angularDistance(before) == 0);
}
