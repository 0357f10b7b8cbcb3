// SPDX-License-Identifier: Apache-2.0
#include "plugins/attitude/vqf/vqf.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/plain_walk.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("vqf");

namespace {

const Eigen::Quaterniond kNedFromEnu(0.0, std::sqrt(0.5), std::sqrt(0.5), 0.0);

/// Angle between the estimated and the true vertical.
double inclination_error(const vqf::Filter& filter, const Eigen::Isometry3d& T_n_b) {
  const Vector3d down_b = (kNedFromEnu * filter.orientation()).conjugate() * Vector3d::UnitZ();
  return std::acos(std::clamp(down_b.dot(T_n_b.linear().transpose() * Vector3d::UnitZ()), -1.0, 1.0));
}

double heading_of(const Eigen::Quaterniond& q_n_b) {
  const Vector3d forward = q_n_b * Vector3d(0, 1, -1);
  return std::atan2(forward.y(), forward.x());
}

}  // namespace

TEST_CASE("a still device gives its inclination at once and its bias within seconds") {
  vqf::Filter filter{vqf::Parameters{}};
  Random random(1, 1);
  const Vector3d bias(0.004, -0.006, 0.008);
  const Eigen::Quaterniond q_b_n(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 0.5).normalized()));
  for (int i = 0; i < 2000; ++i) {
    const Vector3d noise{random.normal(), random.normal(), random.normal()};
    filter.update(bias + 0.002 * noise, q_b_n * Vector3d(0, 0, 9.81) + 0.02 * noise, 0.01);
    if (i == 20) CHECK(std::acos(((filter.orientation()) * (q_b_n * Vector3d::UnitZ())).z()) < 0.01);
  }
  CHECK(filter.at_rest());
  CHECK((filter.bias() - bias).norm() < 5e-4);
}

TEST_CASE(
    "a walking phone has its inclination within a degree, and its heading within a degree per minute once the bias is "
    "known") {
  for (const uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    const PlainWalk walk(1.35, 0.72, seed, 4, 60);
    vqf::Filter filter{vqf::Parameters{}};
    Random random(seed, 4);
    const Vector3d gyro_bias = 0.004 * Vector3d{random.normal(), random.normal(), random.normal()};
    std::vector<double> inclination;
    for (int i = 0; i < 1000; ++i) {  // ten seconds on a table for the bias
      const Vector3d n{random.normal(), random.normal(), random.normal()};
      filter.update(gyro_bias + 0.002 * n, walk.phone.at(0.5).specific_force_b() + 0.03 * n, 0.01);
    }
    CHECK((filter.bias() - gyro_bias).norm() < 5e-4);
    for (int i = 0; i < 50; ++i)  // it is picked up
      filter.update(gyro_bias, walk.phone.at(0).specific_force_b() + Vector3d(0, 0, 2 * std::sin(0.2 * i)), 0.01);
    double start = 0, end = 0, start_t = 0;
    for (double t = 0; t < walk.phone.duration_s(); t += 0.01) {
      const auto k = walk.phone.at(t);
      const Vector3d n{random.normal(), random.normal(), random.normal()};
      filter.update(k.angular_velocity_b + gyro_bias + 0.002 * n, k.specific_force_b() + 0.03 * n, 0.01);
      if (t < 5) continue;
      inclination.push_back(inclination_error(filter, walk.phone.pose(t)));
      end = std::remainder(
          heading_of(kNedFromEnu * filter.orientation()) - heading_of(Eigen::Quaterniond(walk.phone.pose(t).linear())),
          6.283185307179586);
      if (start_t == 0) start = end, start_t = t;
    }
    CHECK(statistics_of(inclination).rmse < 0.0175);
    const double minutes = (walk.phone.duration_s() - start_t) / 60;
    CHECK(std::abs(std::remainder(end - start, 6.283185307179586)) / minutes < 0.01745);
  }
}

TEST_CASE("irregular sampling gives the same orientation as regular sampling") {
  const PlainWalk walk(1.35, 0.72, 5);
  vqf::Filter regular{vqf::Parameters{}}, irregular{vqf::Parameters{}};
  Random random(3, 3);
  double t = 0;
  while (t < 30) {  // long after the rotation, whose centripetal acceleration looks like a tilt of 2.7 degrees
    const double dt = random.uniform(0.002, 0.018);
    t += dt;
    const auto k = walk.phone.at(t - dt / 2);
    irregular.update(k.angular_velocity_b, walk.phone.at(t).specific_force_b(), dt);
  }
  for (double r = 0.01; r < t; r += 0.01) {
    const auto k = walk.phone.at(r - 0.005);
    regular.update(k.angular_velocity_b, walk.phone.at(r).specific_force_b(), 0.01);
  }
  CHECK(inclination_error(irregular, walk.phone.pose(t)) < 0.01);
  CHECK(inclination_error(regular, walk.phone.pose(t)) < 0.01);
}

TEST_CASE("the magnetometer gives north, and a disturbance does not deflect the heading") {
  vqf::Filter filter{vqf::Parameters{}};
  const PlainWalk walk(1.35, 0.72, 5);
  const Vector3d field_n(21e-6, 0, 43e-6);
  double worst_before = 0, worst_during = 0;
  for (int i = 0; i < 2800; ++i) {
    const double t = i * 0.01;
    const auto k = walk.phone.at(t);
    const Eigen::Isometry3d T = walk.phone.pose(t);
    filter.update(k.angular_velocity_b, k.specific_force_b(), 0.01);
    Vector3d field = T.linear().transpose() * field_n;
    const bool disturbed = t > 15 && t < 25;
    if (disturbed) field += Vector3d(40e-6, 10e-6, -20e-6);
    filter.update_magnetometer(field, 0.01);
    const double error = std::abs(
        std::remainder(heading_of(kNedFromEnu * filter.orientation()) - heading_of(Eigen::Quaterniond(T.linear())),
                       6.283185307179586));
    if (t > 5 && t <= 15) worst_before = std::max(worst_before, error);
    if (disturbed) worst_during = std::max(worst_during, error);
    if (t > 16 && disturbed) CHECK(filter.mag_disturbed());
  }
  CHECK(filter.has_heading());
  CHECK(worst_before < 0.05);
  CHECK(worst_during < 0.09);
}

TEST_CASE("a hand that trembles by less than two degrees per second rests, one that trembles by more does not") {
  const vqf::Parameters p;
  const auto rests = [&](double amplitude_radps) {
    vqf::Filter filter{p};
    for (int i = 0; i < 6000; ++i)  // a minute: the initial sway has decayed

      filter.update(Vector3d(amplitude_radps * std::sin(2 * EIGEN_PI * 5 * 0.01 * i), 0, 0), Vector3d(0, 0, 9.81),
                    0.01);
    return filter.at_rest();
  };
  CHECK(rests(0.8 * p.rest_gyro_radps));
  CHECK_FALSE(rests(1.3 * p.rest_gyro_radps));
}
