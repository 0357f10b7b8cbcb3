// SPDX-License-Identifier: Apache-2.0
//
// The walker's parameters estimated by step/odograph.
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "plugins/step/odograph/length_model.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/random.hpp"

using namespace odograph;
using namespace odograph::steps;

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
    walker.on_step(length, heading, 0.06);
    if (walked > 50 * (fix + 1)) ++fix, seen(fix == wrong_fix);
  }
  return walker.factor();
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

TEST_CASE("gentle steps have a separate factor, which a metric camera calibrates within 15 m of a crooked path") {
  for (const double ratio : {0.75, 1.2}) {
    CAPTURE(ratio);
    std::vector<double> errors;
    for (uint64_t seed = 1; seed <= 40; ++seed) {
      Walker walker({});
      const double brisk_before = walker.factor();
      Random random(seed, 6);
      Eigen::Vector2d p(0, 0);
      double heading = random.uniform(-3, 3), since_m = 0, walked_m = 0, hand = 0;
      walker.on_fix(p, 0.1);
      while (walked_m < 16) {
        const double length = 0.5 * (1 + 0.1 * random.normal());
        heading += 0.1 * random.normal();
        hand = 0.9 * hand + 0.15 * std::sqrt(1 - 0.81) * random.normal();
        p += ratio * length * Eigen::Vector2d(std::cos(heading), std::sin(heading));
        since_m += ratio * length, walked_m += ratio * length;
        walker.on_step(length, heading + hand, 0.3, true);
        if (since_m > 5) since_m = 0, walker.on_fix(p, 0.1);
      }
      errors.push_back(std::abs(walker.factor() * walker.gentle_ratio() / ratio - 1));
      // His brisk steps do not differ by as much.
      CHECK(std::abs(walker.factor() - brisk_before) < 0.35 * std::abs(ratio - 1));
    }
    CHECK(percentile(errors, 0.5) < 0.027);
    CHECK(percentile(errors, 0.9) < 0.034);
  }
}

TEST_CASE("one wrong fix of 20 m does not spoil the estimate") {
  size_t spoilt = 0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const double right = learnt(1.08, 1.0, 8, -1, seed), with_wrong = learnt(1.08, 1.0, 8, 5, seed);
    spoilt += std::abs(with_wrong / right - 1) > 0.01;
  }
  CHECK(spoilt <= 5);
}

TEST_CASE("the estimate is saved, and invalid data is not loaded") {
  Walker walker({});
  walker.set_factor(1.07);
  Walker other({});
  const auto bytes = walker.save();
  CHECK(other.load(bytes.data(), bytes.size()));
  CHECK(other.factor() == 1.07);
  CHECK(other.load(bytes.data(), 16));  // without gentle steps
  CHECK_FALSE(other.load(bytes.data(), 3));
  std::vector<uint8_t> wrong(bytes.size(), 0xff);
  CHECK_FALSE(other.load(wrong.data(), wrong.size()));
  CHECK(other.factor() == 1.07);
}

TEST_SUITE_END();
