// SPDX-License-Identifier: Apache-2.0
//
// The walker's parameters estimated by step/odograph.
#include <Eigen/Geometry>

#include "plugins/step/odograph/length_model.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/reconstruct_walk.hpp"
#include "sdk/tools/simulation/walker.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::steps;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("steps");

namespace {

/// A walker whose steps are longer than the model's by `factor`, fixes every 50 m.
double learnt(double factor, double fix_sigma_m, int fixes, int wrong_fix, uint64_t seed) {
  Walker walker({});
  Random random(seed, 2);
  Eigen::Vector2d p(0, 0);
  const double rotation = random.uniform(-3, 3);
  double heading = 0, walked = 0;
  int fix = 0;
  const auto seen = [&](bool wrong) {
    const Eigen::Vector2d error{random.normal(), random.normal()};
    Eigen::Vector2d at = Eigen::Rotation2Dd(rotation) * p + fix_sigma_m * error;
    if (wrong) at += 20 * Eigen::Vector2d{random.normal(), random.normal()}.normalized();
    walker.on_fix(at, fix_sigma_m);
  };
  seen(false);
  while (fix < fixes) {
    const double length = 0.65 * (1 + 0.03 * random.normal());
    heading += 0.01 * random.normal();
    p += factor * length * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    walked += factor * length;
    walker.on_step({.m = length, .pace = 0, .own_sigma = 0.06, .common_sigma = 0}, heading);
    if (walked > 50 * (fix + 1)) ++fix, seen(fix == wrong_fix);
  }
  return walker.factor(0);
}

}  // namespace

TEST_CASE("fixes every 50 m calibrate the walker's factor within 200 m") {
  std::vector<double> errors;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const double factor = 0.85 + 0.005 * static_cast<double>(seed);
    errors.push_back(std::abs(learnt(factor, 1.0, 4, -1, seed) / factor - 1));
  }
  CHECK(percentile(errors, 0.5) < 0.010);
  CHECK(percentile(errors, 0.8) < 0.015);
}

TEST_CASE("slow steps have a slope of their own, which a metric camera calibrates within 15 m of a crooked path") {
  constexpr double kSlow = -0.4;  // 1.15 Hz
  for (const double ratio : {0.75, 1.2}) {
    CAPTURE(ratio);
    std::vector<double> errors;
    for (uint64_t seed = 1; seed <= 40; ++seed) {
      Walker walker({});
      const double brisk_before = walker.factor(0);
      Random random(seed, 6);
      Eigen::Vector2d p(0, 0);
      double heading = random.uniform(-3, 3), since_m = 0, walked_m = 0, hand = 0;
      walker.on_fix(p, 0.1, true);
      while (walked_m < 16) {
        const double length = 0.5 * (1 + 0.1 * random.normal());
        heading += 0.1 * random.normal();
        hand = 0.9 * hand + 0.15 * std::sqrt(1 - 0.81) * random.normal();
        p += ratio * length * Eigen::Vector2d(std::cos(heading), std::sin(heading));
        since_m += ratio * length, walked_m += ratio * length;
        walker.on_step({.m = length, .pace = kSlow, .own_sigma = 0.3, .common_sigma = 0, .gentle = true},
                       heading + hand);
        if (since_m > 5) since_m = 0, walker.on_fix(p, 0.1, true);
      }
      errors.push_back(std::abs(walker.factor(kSlow) / ratio - 1));
      // His brisk steps do not differ by as much.
      CHECK(std::abs(walker.factor(0) - brisk_before) < 0.35 * std::abs(ratio - 1));
    }
    CHECK(percentile(errors, 0.9) <
          0.5 * Walker::Parameters().factor_sigma);  // a quarter off becomes half a stranger's
  }
}

TEST_CASE("fixes once a second with errors correlated over 20 s calibrate the factor with a consistent sigma") {
  constexpr double kSigma_m = 5, kAlike = 0.951229;  // after a second: exp(-1/20)
  // A Gauss-Markov error sampled each second is as informative as independent errors of this size (fix/gnss, README).
  const double stated_m = kSigma_m * std::sqrt((1 + kAlike) / (1 - kAlike));
  std::vector<double> sigmas;
  double nees = 0;
  constexpr int kWalkers = 100;
  for (uint64_t seed = 1; seed <= kWalkers; ++seed) {
    Walker walker({});
    Random random(seed, 7);
    const double factor = 1 + Walker::Parameters().factor_sigma * random.normal(), rotation = random.uniform(-3, 3);
    Eigen::Vector2d p(0, 0), error = kSigma_m * Eigen::Vector2d{random.normal(), random.normal()};
    for (int second = 0; second < 600; ++second) {
      const Eigen::Vector2d news{random.normal(), random.normal()};
      error = kAlike * error + kSigma_m * std::sqrt(1 - kAlike * kAlike) * news;
      walker.on_fix(Eigen::Rotation2Dd(rotation) * p + error, stated_m);
      const double heading = second < 250 ? 0 : second < 450 ? kPi / 2 : kPi;
      p += factor * 1.3 * Eigen::Vector2d(std::cos(heading), std::sin(heading));
      walker.on_step({.m = 1.3, .pace = 0, .own_sigma = 0.03, .common_sigma = 0}, heading);
    }
    sigmas.push_back(walker.factor_sigma(0));
    nees += squared((walker.factor(0) / factor - 1) / walker.factor_sigma(0)) / kWalkers;
  }
  CHECK(percentile(sigmas, 0.5) < 0.25 * Walker::Parameters().factor_sigma);  // ten minutes outdoors
  CHECK(nees == Between{0.5, 2});
}

TEST_CASE("one wrong fix of 20 m does not spoil the estimate") {
  size_t spoilt = 0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const double right = learnt(1.08, 1.0, 8, -1, seed), with_wrong = learnt(1.08, 1.0, 8, 5, seed);
    spoilt += std::abs(with_wrong / right - 1) > 0.01;
  }
  CHECK(spoilt <= 5);
}

TEST_CASE("a known walker's steps grow with the cadence above the usual one, an unknown walker's do not") {
  constexpr double kUsual = 0.1, kFast = 0.3;
  Walker walker({});
  CHECK(walker.factor(kFast) == walker.factor(kUsual));
  const double sigma = walker.factor_sigma(kUsual);
  double north_m = 0;
  for (int i = 0; i < 200; ++i) {
    if (i % 50 == 0) walker.on_fix({north_m, 0}, 0.3);
    walker.on_step({.m = 0.7, .pace = kUsual, .own_sigma = 0.06, .common_sigma = 0}, 0);
    north_m += 1.15 * 0.7;
  }
  CHECK(walker.factor(kUsual) == doctest::Approx(1.15).epsilon(0.01));
  CHECK(walker.factor_sigma(kUsual) < 0.3 * sigma);
  CHECK(walker.factor(kFast) / walker.factor(kUsual) == doctest::Approx(std::exp(0.8 * 0.2)).epsilon(0.03));
  Walker next({});
  const auto bytes = walker.save();
  REQUIRE(next.load(bytes.data(), bytes.size()));
  CHECK(next.factor(kFast) == doctest::Approx(walker.factor(kFast)).epsilon(0.02));
}

TEST_CASE("the estimate is saved, one of an earlier law is not used, and invalid data is not loaded") {
  Walker walker({});
  walker.set_factor(1.07);
  Walker other({});
  const auto bytes = walker.save();
  CHECK(other.load(bytes.data(), bytes.size()));
  CHECK(other.factor(0) == 1.07);
  const double earlier[4] = {0.9, 1e-3, 1.0, 0.04};
  CHECK(other.load(reinterpret_cast<const uint8_t*>(earlier), sizeof earlier));
  CHECK_FALSE(other.load(bytes.data(), 3));
  std::vector<uint8_t> wrong(bytes.size(), 0xff);
  CHECK_FALSE(other.load(wrong.data(), wrong.size()));
  CHECK(other.factor(0) == 1.07);
}

TEST_SUITE_BEGIN("world");

TEST_CASE("a real walk is retraced with its waypoints, its orientation and the bounce of its steps" *
          doctest::test_suite("world_data")) {
  const auto folder = data_or_skip("phone_walks");
  if (folder.empty()) return;
  const auto walk = required(read_recording(folder / "site2_F1_5dd35c7327889b0006b76850.txt"));
  const auto traced = required(reconstruct_walk(*walk));
  const auto marks = traced->journey.waypoints;
  REQUIRE(marks.size() == walk->waypoints().size());
  const Motion& phone = traced->journey.phone;
  for (const auto& mark : marks) CHECK((phone.pose(mark.t_s).translation() - mark.p_n).head<2>().norm() < 1e-6);
  // The phone points in the walking direction.
  double ahead = 0, length = 0;
  for (double t = marks.front().t_s; t < marks.back().t_s; t += 0.1) {
    const auto k = phone.at(t);
    const Vector3d f = k.T_n_b.linear() * Vector3d(0, 1, -1);
    ahead += k.velocity_n.head<2>().dot(f.head<2>().normalized()), length += k.velocity_n.head<2>().norm();
  }
  CHECK(ahead > 0.8 * length);
  // Ideal sensors on the retraced motion against the real ones: equal second by second up to a constant, since pictures
  // and samples must not contradict each other.
  struct Second {
    Vector3d accel = Vector3d::Zero(), gyro = Vector3d::Zero();
    int n = 0;
  };
  std::map<int, Second> seconds;
  double error = 0, signal = 0;
  size_t n = 0;
  for (const auto& m : walk->messages) {
    if (m.message.header().type != ODO_TYPE_IMU) continue;
    const auto& imu = as<odo_imu>(m.message.header());
    const double t = static_cast<double>(imu.header.t_ns - traced->start_ns) * 1e-9;
    if (t < 2 || t > phone.duration_s() - 2) continue;
    const auto felt = phone.at(t);
    Second& second = seconds[static_cast<int>(t)];
    if (imu.header.flags & ODO_IMU_GYRO) second.gyro += felt.angular_velocity_b - Vector3d(imu.gyro_b);
    if (!(imu.header.flags & ODO_IMU_ACCEL)) continue;
    const Vector3d real(imu.accel_b), off = felt.specific_force_b() - real;
    second.accel += off, ++second.n;
    error += off.squaredNorm(), signal += std::pow(real.norm() - 9.81, 2), ++n;
  }
  REQUIRE(n > 1000);
  MESSAGE(std::sqrt(error / static_cast<double>(n)), " of ", std::sqrt(signal / static_cast<double>(n)), " m/s^2");
  CHECK(std::sqrt(error / static_cast<double>(n)) < 0.5 * std::sqrt(signal / static_cast<double>(n)));
  double accel = 0, gyro = 0;
  Vector3d mean_accel = Vector3d::Zero(), mean_gyro = Vector3d::Zero();
  for (auto& [_, s] : seconds) {
    s.accel /= s.n, s.gyro /= s.n;
    mean_accel += s.accel / static_cast<double>(seconds.size()),
        mean_gyro += s.gyro / static_cast<double>(seconds.size());
  }
  for (const auto& [_, s] : seconds)
    accel += (s.accel - mean_accel).squaredNorm(), gyro += (s.gyro - mean_gyro).squaredNorm();
  const double count = 3 * static_cast<double>(seconds.size());
  MESSAGE(std::sqrt(accel / count), " m/s^2, ", std::sqrt(gyro / count), " rad/s from second to second");
  CHECK(std::sqrt(accel / count) < 0.05);
  CHECK(std::sqrt(gyro / count) < 0.005);
}

TEST_CASE("pictures rendered along a real walk come with that walk's own samples" * doctest::test_suite("world_data")) {
  const auto folder = data_or_skip("phone_walks");
  if (folder.empty()) return;
  const TemporaryFolder out;
  auto walk = required(read_recording(folder / "site2_B1_5dd506abd48f840006f14812.txt"));
  Scenario s;
  s.world.type = "room";
  s.camera.width = 160, s.camera.height = 120, s.camera.focal_px = 120, s.camera.rate_hz = 5;
  const Recording made = recorded(s, 1, out / "h.odo", {.walk = &*walk});
  size_t real = 0, same = 0, frames = 0;
  for (const auto& m : walk->messages) real += m.message.header().type == ODO_TYPE_IMU;
  for (const auto& m : made.messages) {
    same += m.message.header().type == ODO_TYPE_IMU;
    frames += m.message.header().type == ODO_TYPE_FRAME;
  }
  CHECK(same == real);
  CHECK(frames > 90);
  CHECK(made.truth.size() == frames);
  CHECK(made.waypoints().size() == walk->waypoints().size());
  walk->phone_attitudes.clear();
  const auto without = simulate(s, 1, out / "x.odo", {.walk = &*walk});
  REQUIRE_FALSE(without.ok());
  CHECK(contains(without.failure().text, "rotation vector"));
}
