// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/localizer/gyro_attitude_filter.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("gyro_attitude_filter");

namespace {

constexpr int64_t kSecond = 1'000'000'000;

/// A body that rotates by `rate_b` and accelerates by `accel_n`; the gyroscope has the bias `bias`.
void add_imu(GyroAttitudeFilter& filter, Eigen::Quaterniond q, int64_t from, int64_t to, const Vector3d& rate_b,
             const Vector3d& accel_n, const Vector3d& bias) {
  constexpr int64_t kStep = 5'000'000;
  for (int64_t t = from + kStep; t <= to; t += kStep) {
    const double angle = rate_b.norm() * 0.005;
    if (angle > 0) q = q * Eigen::Quaterniond(Eigen::AngleAxisd(angle, rate_b.normalized()));
    filter.add_imu(imu_at(t, rate_b + bias, q.conjugate() * (accel_n - Vector3d(0, 0, 9.81))));
  }
}

const Eigen::Quaterniond kLevel = Eigen::Quaterniond::Identity();
const Eigen::Matrix3d kOneDegree = Eigen::Matrix3d::Identity() * 3e-4;

}  // namespace

TEST_CASE("a gyroscope attitude filter rotates with the body, for any camera mount") {
  GyroAttitudeFilter filter;
  filter.reset(kLevel, kOneDegree);
  const Eigen::Quaterniond mounted(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
  add_imu(filter, kLevel, 0, kSecond, {0.3, -0.2, 1.0}, Vector3d::Zero(), Vector3d::Zero());
  const auto imu = required(filter.between(0, kSecond, mounted));
  const Eigen::Quaterniond rotation_b(Eigen::AngleAxisd(std::sqrt(1.13), Vector3d(0.3, -0.2, 1.0).normalized()));
  CHECK(imu->q_c0_c1.angularDistance(mounted.conjugate() * rotation_b * mounted) < 1e-9);
  CHECK_FALSE(filter.between(0, kSecond * 2, mounted));     // samples end before
  CHECK_FALSE(filter.between(-kSecond, kSecond, mounted));  // or start later
}

TEST_CASE("at rest pictures give the gyroscope's bias and the accelerometer the vertical, and braking gives neither") {
  GyroAttitudeFilter filter;
  const Eigen::Quaterniond leaning(Eigen::AngleAxisd(0.02, Vector3d::UnitX()));
  filter.reset(leaning, kOneDegree);
  const Vector3d bias(0.006, -0.004, 0.003);
  constexpr int64_t kFrame = 100'000'000;
  const auto drive = [&](int64_t from, int64_t to, const Vector3d& accel_n, bool standing) {
    for (int64_t t = from; t < to; t += kFrame) {
      add_imu(filter, kLevel, t, t + kFrame, Vector3d::Zero(), accel_n, bias);
      const auto imu = required(filter.between(t, t + kFrame, kLevel));
      filter.propagate(imu->q_c0_c1, imu->dt_s);
      if (standing) filter.update_relative_rotation(imu->q_c0_c1, kLevel, 0, imu->dt_s);
      filter.update_gravity(imu->force_c, standing);
    }
  };
  drive(0, 5 * kSecond, Vector3d::Zero(), true);
  CHECK((filter.bias_c() - bias).norm() < 0.0005);
  const Vector3d up = filter.q_n_c() * -Vector3d::UnitZ();
  CHECK(std::hypot(up.x(), up.y()) < 0.004);
  drive(5 * kSecond, 10 * kSecond, {1.8, 0, 0}, false);  // acceleration for five seconds
  const Vector3d after = filter.q_n_c() * -Vector3d::UnitZ();
  CHECK(std::hypot(after.x(), after.y()) < 0.012);
  const double sigma = std::sqrt(filter.covariance_n()(0, 0));
  CHECK(sigma == Between{0.001, 0.02});
}

TEST_CASE("orientation fixes correct a gyroscope attitude filter and its bias, and an outlier is rejected") {
  GyroAttitudeFilter filter;
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
